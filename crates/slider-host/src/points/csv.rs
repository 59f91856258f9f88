//! Points from text.

use super::{Points, Positions};
use crate::Error;

impl Points {
    /// Reads `t_s,x_m` or `t_s,x_m,u_x_m`: a header, then a point a line in the order of time; `u_x_m` is the standard
    /// uncertainty of the position. Empty lines, and lines that begin with `#`, are skipped.
    ///
    /// ```
    /// use slider_host::points::Points;
    /// let points = Points::from_csv("t_s,x_m\n0.0,0.0\n0.1,0.05\n0.2,0.10\n")?;
    /// assert_eq!(points.x_m, [0.0, 0.05, 0.10]);
    /// let error = Points::from_csv("t_s,x_m\n0.0,0.0\n0.1;0.05\n").unwrap_err();
    /// assert_eq!(error.to_string(), "points, line 3: 1 values, expected 2");
    /// # Ok::<(), slider_host::Error>(())
    /// ```
    pub fn from_csv(text: &str) -> Result<Self, Error> {
        let fail = |line: usize, reason: String| Error::Points { line, reason };
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut lines =
            (1..).zip(text.lines().map(str::trim)).filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
        let (line, header) = lines.next().ok_or_else(|| fail(1, "there is no header".to_owned()))?;
        let names: Vec<&str> = header.split(',').map(str::trim).collect();
        let with_std = match names.as_slice() {
            ["t_s", "x_m"] => false,
            ["t_s", "x_m", "u_x_m"] => true,
            _ => return Err(fail(line, format!("the header is '{header}', expected t_s,x_m or t_s,x_m,u_x_m"))),
        };
        let (mut t_s, mut x_m, mut std_m) = (Vec::new(), Vec::new(), Vec::new());
        for (line, row) in lines {
            let cells: Vec<&str> = row.split(',').map(str::trim).collect();
            if cells.len() != names.len() {
                return Err(fail(line, format!("{} values, expected {}", cells.len(), names.len())));
            }
            let mut numbers = [0.0; 3];
            for ((cell, name), number) in cells.iter().zip(&names).zip(&mut numbers) {
                *number = match cell.parse::<f64>() {
                    Ok(parsed) if parsed.is_finite() => parsed,
                    _ => return Err(fail(line, format!("{name} is '{cell}', expected a finite number"))),
                };
            }
            let [t, x, std] = numbers;
            if let Some(&last) = t_s.last()
                && t <= last
            {
                return Err(fail(line, format!("t_s is {t}, which is not after {last}")));
            }
            if std < 0.0 {
                return Err(fail(line, format!("u_x_m is {std}, expected 0 or more")));
            }
            t_s.push(t);
            x_m.push(x);
            std_m.push(std);
        }
        let positions = if with_std { Positions::Independent(std_m) } else { Positions::Unknown };
        let time_std_s = vec![0.0; t_s.len()];
        Ok(Self { t_s, x_m, time_std_s, positions, warnings: Vec::new() })
    }
}
