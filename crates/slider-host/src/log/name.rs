//! Names of files.

/// `run-YYYYMMDD-hhmmss-N.jsonl` for run `number`, begun at `started_s` seconds since 1970-01-01 UTC.
///
/// Days are turned into a date of the proleptic Gregorian calendar as in *Reference*.
///
/// ```
/// use slider_host::log::file_name;
/// assert_eq!(file_name(951_782_399.9, 12), "run-20000228-235959-12.jsonl");
/// assert_eq!(file_name(951_782_400.0, 12), "run-20000229-000000-12.jsonl");
/// ```
///
/// # Reference
///
/// H. Hinnant, *chrono-Compatible Low-Level Date Algorithms*, `civil_from_days`, 2021.
pub fn file_name(started_s: f64, number: u16) -> String {
    let seconds = started_s.max(0.0) as u64;
    let (days, second) = (seconds / 86_400, seconds % 86_400);
    // Years begin in March, so that a leap day is the last day of its year; 400 years are 146097 days.
    let shifted = days + 719_468;
    let (era, day_of_era) = (shifted / 146_097, shifted % 146_097);
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * from_march + 2) / 5 + 1;
    let month = if from_march < 10 { from_march + 3 } else { from_march - 9 };
    let year = era * 400 + year_of_era + u64::from(month <= 2);
    let (hour, minute, second) = (second / 3600, second / 60 % 60, second % 60);
    format!("run-{year:04}{month:02}{day:02}-{hour:02}{minute:02}{second:02}-{number}.jsonl")
}

#[cfg(test)]
mod tests {
    use super::file_name;

    /// `date -u -d @SECONDS +%Y%m%d-%H%M%S` of GNU coreutils.
    #[test]
    fn names_are_dates_of_the_calendar() {
        for (seconds, name) in [
            (0.0, "19700101-000000"),
            (86_399.0, "19700101-235959"),
            (94_694_400.0, "19730101-000000"),
            (1_709_164_800.0, "20240229-000000"),
            (1_709_251_200.0, "20240301-000000"),
            (1_735_689_599.0, "20241231-235959"),
            (1_795_345_383.0, "20261122-110303"),
            (4_107_542_399.0, "21000228-235959"),
            (4_107_542_400.0, "21000301-000000"),
        ] {
            assert_eq!(file_name(seconds, 5), format!("run-{name}-5.jsonl"));
        }
        assert_eq!(file_name(f64::NAN, 0), "run-19700101-000000-0.jsonl");
    }
}
