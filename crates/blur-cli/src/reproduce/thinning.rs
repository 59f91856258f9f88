//! Fewer cases, evenly over everything that is varied.

/// The fraction of the golden section: its multiples fill the unit interval evenly however many they are.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// The numbers of the cases that are measured of `count`: one of every `step` that follow each other.
///
/// Its place among them moves on by the golden section. Whatever comes back with some period in the order of the cases, a
/// picture, an angle or a shot, is met evenly; every `step`-th case would meet the same few of them again and again.
pub(super) fn thinned(count: usize, step: usize) -> impl Iterator<Item = usize> {
    let step = step.max(1);
    (0..count.div_ceil(step)).map(move |block| {
        let first = block * step;
        let size = step.min(count - first);
        let place = (0.5 + block as f64 * GOLDEN).fract();
        first + (place * size as f64) as usize
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_left_out_at_step_1() {
        assert!(thinned(7, 1).eq(0..7));
        assert_eq!(thinned(0, 3).count(), 0);
    }

    #[test]
    fn a_share_of_the_cases_is_measured_each_once() {
        for (count, step) in [(100, 7), (5, 9), (64, 8), (1, 1000)] {
            let found: Vec<usize> = thinned(count, step).collect();
            assert_eq!(found.len(), count.div_ceil(step));
            assert!(found.windows(2).all(|pair| pair[0] < pair[1]) && found.iter().all(|&case| case < count));
        }
    }

    #[test]
    fn every_dimension_is_met_evenly() {
        // Pictures by angles, angles by posters by shots, speeds by posters by shots.
        for dims in [vec![39, 91], vec![91, 5, 5], vec![10, 5, 10]] {
            let count: usize = dims.iter().product();
            for step in [2, 3, 5, 7, 10, 13, 25, 50, 91] {
                let found: Vec<usize> = thinned(count, step).collect();
                let mut period = count;
                for &size in &dims {
                    period /= size;
                    // Thirds, so that there is something to count in each: the lowest, middle and highest values.
                    let mut thirds = [0_usize; 3];
                    for case in &found {
                        thirds[case / period % size * 3 / size] += 1;
                    }
                    for (third, &met) in thirds.iter().enumerate() {
                        let values = (0..size).filter(|value| value * 3 / size == third).count();
                        let even = (values * found.len()) as f64 / size as f64;
                        assert!(
                            (met as f64 - even).abs() <= 0.25 * even + 2.0,
                            "{dims:?} / {step}: {thirds:?} of {size}"
                        );
                    }
                }
            }
        }
    }
}
