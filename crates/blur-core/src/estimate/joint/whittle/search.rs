//! The exhaustive search for starting points: every direction and length against the log spectrum.

use std::f64::consts::PI;
use std::ops::Range;

use super::periodogram::Periodogram;
use crate::estimate::LengthRange;
use crate::psf::sinc;
use crate::spectrum::ln;

/// Directions tried over the half turn.
const ANGLES: usize = 90;
/// Lengths of a band: the dark lines within it number from this many ...
const LEAST_LINES: f64 = 1.6;
/// ... to this many.
const MOST_LINES: f64 = 11.0;
/// Ratio of neighbouring lengths.
const LENGTH_STEP: f64 = 1.04;
/// Levels that fill the dark lines, by noise or by light that does not share the motion.
const FILLS: [f64; 2] = [0.003, 0.03];
/// Bins are pooled until a band is about this many pools in radius.
const RADIUS: usize = 64;
/// Steps along the motion.
const STEPS: usize = 128;
/// Lines that pools are summed into side by side.
const LINES: usize = 4;
const RINGS: usize = RADIUS + 1;
/// Angular terms taken out of the log spectrum: `cos` and `sin` of 2 and 4 times the direction, each alone and times
/// the logarithm of the radius.
const HARMONICS: usize = 8;
/// Pools that the overall variance counts for in that of a ring.
const RING_COUNTS: f32 = 10.0;
/// Limit of the levelled values in standard deviations.
const LIMIT: f32 = 2.5;
/// Candidates taken from one band.
pub(super) const CANDIDATES: usize = 4;

/// A direction and a length worth a fit.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Candidate {
    /// Radians.
    pub(super) angle: f64,
    pub(super) length: f64,
    /// Gain in log-likelihood over no blur, of log powers taken as normal.
    pub(super) gain: f64,
}

/// What a ring of equal frequency tells.
#[derive(Debug, Clone, Copy, Default)]
struct Ring {
    sum: f32,
    count: f32,
    /// Share of the signal in the power.
    signal: f32,
    /// Signal share over the variance of a bin's value: by it values count.
    weight: f32,
}

/// The search in the frequencies up to a limit.
#[derive(Debug)]
pub(super) struct Band {
    pub(super) most_frequency: f64,
    /// Pool of each bin of the band.
    pool_of: Vec<(u32, u32)>,
    /// Of each pool, ring by ring.
    u: Vec<f32>,
    v: Vec<f32>,
    count: Vec<f32>,
    ring: Vec<u16>,
    harmonics: [Vec<f32>; HARMONICS],
    /// Pools of each ring.
    pools: [Range<usize>; RINGS],
    inverse: nalgebra::SMatrix<f64, HARMONICS, HARMONICS>,
    lengths: Vec<f64>,
    /// Templates of each length and fill over the steps, and the squared norm of each ring of them when levelled.
    templates: Vec<[f32; STEPS]>,
    norms: Vec<[f32; RINGS]>,
    weighted_norms: Vec<f32>,
    values: Vec<f32>,
    rings: [Ring; RINGS],
    gains: Vec<f32>,
    pub(super) found: Vec<Candidate>,
}

impl Band {
    /// The band up to `most_frequency` of `periodogram`; `None` when no length of `range` draws lines in it.
    pub(super) fn new(periodogram: &Periodogram, most_frequency: f64, range: LengthRange) -> Option<Self> {
        let (rows, columns) = periodogram.dim();
        let lengths = lengths(most_frequency, range);
        if lengths.is_empty() {
            return None;
        }
        let side = rows.min(columns) as f64;
        let pool = (most_frequency * side / RADIUS as f64).round().max(1.0);
        // Pools lie on a grid of whole bins; the frequency is that of the bins inside.
        let (pool_u, pool_v) = (pool / columns as f64, pool / rows as f64);
        let (wide, half) = ((most_frequency / pool_u) as usize + 2, (most_frequency / pool_v) as usize + 2);
        let mut place = vec![u32::MAX; wide * 2 * half];
        let mut band = Self {
            most_frequency,
            pool_of: Vec::new(),
            u: Vec::new(),
            v: Vec::new(),
            count: Vec::new(),
            ring: Vec::new(),
            harmonics: std::array::from_fn(|_| Vec::new()),
            pools: std::array::from_fn(|_| 0..0),
            inverse: nalgebra::SMatrix::zeros(),
            lengths,
            templates: Vec::new(),
            norms: Vec::new(),
            weighted_norms: Vec::new(),
            values: Vec::new(),
            rings: [Ring::default(); RINGS],
            gains: Vec::new(),
            found: Vec::with_capacity(CANDIDATES),
        };
        for (bin, (&u, &v)) in periodogram.u.iter().zip(&periodogram.v).enumerate() {
            if f64::from(u).powi(2) + f64::from(v).powi(2) >= most_frequency * most_frequency {
                continue;
            }
            // The first of the pools is the one at -half.
            let cell = |x: f32, pool: f64, first: usize| (f64::from(x) / pool + 1e-6 + first as f64) as usize;
            let slot = &mut place[cell(v, pool_v, half) * wide + cell(u, pool_u, 0)];
            if *slot == u32::MAX {
                *slot = band.u.len() as u32;
                band.u.push(0.0);
                band.v.push(0.0);
                band.count.push(0.0);
            }
            let pool = *slot as usize;
            band.pool_of.push((bin as u32, *slot));
            band.u[pool] += u;
            band.v[pool] += v;
            band.count[pool] += 1.0;
        }
        for ((u, v), count) in band.u.iter_mut().zip(&mut band.v).zip(&band.count) {
            *u /= count;
            *v /= count;
        }
        band.sort();
        band.expand();
        band.lay_templates();
        Some(band)
    }

    /// Sorts the pools by their rings.
    fn sort(&mut self) {
        let ring_of = |(&u, &v): (&f32, &f32)| {
            let ring = (f64::from(u).hypot(f64::from(v)) / self.most_frequency * RADIUS as f64) as usize;
            ring.min(RINGS - 1)
        };
        let rings: Vec<usize> = self.u.iter().zip(&self.v).map(ring_of).collect();
        let mut next = 0;
        for (ring, pools) in self.pools.iter_mut().enumerate() {
            let first = next;
            next += rings.iter().filter(|&&other| other == ring).count();
            *pools = first..next;
        }
        let mut places = self.pools.clone().map(|pools| pools.start);
        let place_of: Vec<usize> = rings
            .iter()
            .map(|&ring| {
                places[ring] += 1;
                places[ring] - 1
            })
            .collect();
        for values in [&mut self.u, &mut self.v, &mut self.count] {
            let mut sorted = vec![0.0; values.len()];
            values.iter().zip(&place_of).for_each(|(&value, &place)| sorted[place] = value);
            *values = sorted;
        }
        for (_, pool) in &mut self.pool_of {
            *pool = place_of[*pool as usize] as u32;
        }
        self.ring = (0_u16..).zip(&self.pools).flat_map(|(ring, pools)| pools.clone().map(move |_| ring)).collect();
    }

    /// Computes the harmonics of the pools.
    fn expand(&mut self) {
        let mut gram = nalgebra::SMatrix::<f64, HARMONICS, HARMONICS>::identity() * 1e-9;
        for ((&u, &v), &count) in self.u.iter().zip(&self.v).zip(&self.count) {
            let radius = f64::from(u).hypot(f64::from(v));
            let x = (radius / self.most_frequency).ln() + 1.0;
            let (sin, cos) = (-f64::from(v) / radius, f64::from(u) / radius);
            let (c2, s2) = (cos * cos - sin * sin, 2.0 * cos * sin);
            let (c4, s4) = (c2 * c2 - s2 * s2, 2.0 * c2 * s2);
            let h = [c2, s2, c4, s4, x * c2, x * s2, x * c4, x * s4];
            for (i, &a) in h.iter().enumerate() {
                for (j, &b) in h.iter().enumerate() {
                    gram[(i, j)] += f64::from(count) * a * b;
                }
            }
            self.harmonics.iter_mut().zip(h).for_each(|(column, h)| column.push(h as f32));
        }
        self.inverse = gram.try_inverse().unwrap_or_else(nalgebra::SMatrix::zeros);
    }

    /// Computes the templates and their norms.
    fn lay_templates(&mut self) {
        self.values = vec![0.0; self.u.len()];
        self.gains = vec![0.0; ANGLES * self.lengths.len()];
        self.weighted_norms = vec![0.0; FILLS.len() * self.lengths.len()];
        // The norm hardly depends on the direction, because what is levelled away has none; any direction will do.
        let (sin, cos) = (0.4_f64.sin() as f32, 0.4_f64.cos() as f32);
        let per_step = self.per_step();
        let step_of = |(&u, &v): (&f32, &f32)| ((u * cos - v * sin).abs() * per_step) as usize % STEPS;
        let steps: Vec<usize> = self.u.iter().zip(&self.v).map(step_of).collect();
        for i in 0..self.lengths.len() {
            for fill in FILLS {
                let length = self.lengths[i];
                let template: [f32; STEPS] = std::array::from_fn(|k| {
                    let s = (k as f64 + 0.5) / f64::from(per_step);
                    (sinc(length * s).powi(2) + fill).ln() as f32
                });
                for (value, &step) in self.values.iter_mut().zip(&steps) {
                    *value = template[step];
                }
                self.level();
                let norm_of = |pools: &Range<usize>| {
                    let values = &self.values[pools.clone()];
                    dot3(values, values, &self.count[pools.clone()])
                };
                self.norms.push(self.pools.each_ref().map(norm_of));
                self.templates.push(template);
            }
        }
    }

    /// Whether a blur of `length` draws lines in this band, neither too few nor too many.
    pub(super) fn covers(&self, length: f64) -> bool {
        self.lengths.first().is_some_and(|&first| length > first * 0.8)
            && self.lengths.last().is_some_and(|&last| length < last)
    }

    fn per_step(&self) -> f32 {
        (STEPS as f64 / self.most_frequency * 0.999) as f32
    }

    /// Takes ring means and angular harmonics out of the values.
    fn level(&mut self) {
        let mut moments = nalgebra::SVector::<f64, HARMONICS>::zeros();
        for (ring, pools) in self.rings.iter_mut().zip(&self.pools) {
            let (values, count) = (&mut self.values[pools.clone()], &self.count[pools.clone()]);
            (ring.sum, ring.count) = (dot(values, count), count.iter().sum());
            let mean = ring.sum / ring.count;
            for value in values.iter_mut() {
                *value -= mean;
            }
            for (moment, harmonic) in moments.iter_mut().zip(&self.harmonics) {
                *moment += f64::from(dot3(values, count, &harmonic[pools.clone()]));
            }
        }
        let amplitudes = self.inverse * moments;
        for (harmonic, &amplitude) in self.harmonics.iter().zip(&amplitudes) {
            let amplitude = amplitude as f32;
            self.values.iter_mut().zip(harmonic).for_each(|(value, &h)| *value -= h * amplitude);
        }
    }

    /// Fills `found` with the best directions and lengths of a spectrum with these powers and `ln(power + noise)` of
    /// each bin.
    pub(super) fn search(&mut self, powers: &[f32], logs: &[f32], noise: f32) {
        self.values.fill(0.0);
        for ring in &mut self.rings {
            ring.signal = 0.0;
        }
        for &(bin, pool) in &self.pool_of {
            self.values[pool as usize] += logs[bin as usize];
            self.rings[usize::from(self.ring[pool as usize])].signal += powers[bin as usize];
        }
        for (value, &count) in self.values.iter_mut().zip(&self.count) {
            *value /= count;
        }
        self.level();
        let squares: f32 = self.values.iter().zip(&self.count).map(|(&x, &n)| n * x * x).sum();
        let variance = squares / self.values.len() as f32;
        if variance.is_nan() || variance <= 0.0 {
            self.found.clear();
            return;
        }
        // Variance of each ring, held together by the overall one where a ring has few pools.
        for ring in &mut self.rings {
            (ring.sum, ring.weight) = (variance * RING_COUNTS, RING_COUNTS);
        }
        let std = variance.sqrt();
        for ((value, &count), &ring) in self.values.iter_mut().zip(&self.count).zip(&self.ring) {
            let limit = LIMIT * std / count.sqrt();
            *value = value.clamp(-limit, limit);
            let ring = &mut self.rings[usize::from(ring)];
            ring.sum += count * *value * *value;
            ring.weight += 1.0;
        }
        for ring in self.rings.iter_mut().filter(|ring| ring.count > 0.0) {
            let mean = ring.signal / ring.count;
            ring.signal = ((mean - noise) / (mean + noise)).max(0.0);
            ring.weight = ring.signal * ring.weight / ring.sum;
        }
        // From here on the values are weighted.
        for ((value, &count), &ring) in self.values.iter_mut().zip(&self.count).zip(&self.ring) {
            *value *= count * self.rings[usize::from(ring)].weight;
        }
        for (norm, rings) in self.weighted_norms.iter_mut().zip(&self.norms) {
            *norm = rings.iter().zip(&self.rings).map(|(norm, ring)| norm * ring.signal * ring.weight).sum();
        }
        let per_step = self.per_step();
        for (angle, gains) in self.gains.chunks_exact_mut(self.lengths.len()).enumerate() {
            let (sin, cos) = (PI * angle as f64 / ANGLES as f64).sin_cos();
            let (sin, cos) = (sin as f32 * per_step, cos as f32 * per_step);
            let step_of = |u: f32, v: f32| (u * cos - v * sin).abs() as usize % STEPS;
            // Neighbours often fall on one step: with a line for each of them none waits for the one before.
            let mut lines = [[0.0_f32; STEPS]; LINES];
            let (values, last_values) = self.values.as_chunks::<LINES>();
            let ((u, last_u), (v, last_v)) = (self.u.as_chunks::<LINES>(), self.v.as_chunks::<LINES>());
            for ((values, u), v) in values.iter().zip(u).zip(v) {
                for (((line, value), &u), &v) in lines.iter_mut().zip(values).zip(u).zip(v) {
                    line[step_of(u, v)] += value;
                }
            }
            let [mut line, others @ ..] = lines;
            for other in others {
                line.iter_mut().zip(other).for_each(|(sum, value)| *sum += value);
            }
            for ((value, &u), &v) in last_values.iter().zip(last_u).zip(last_v) {
                line[step_of(u, v)] += value;
            }
            let pairs = self.templates.chunks_exact(FILLS.len()).zip(self.weighted_norms.chunks_exact(FILLS.len()));
            for (gain, (templates, norms)) in gains.iter_mut().zip(pairs) {
                *gain = 0.0;
                for (template, &norm) in templates.iter().zip(norms) {
                    let match_ = dot(&line, template).max(0.0);
                    *gain = gain.max(match_ * match_ / (2.0 * norm).max(f32::MIN_POSITIVE));
                }
            }
        }
        self.pick();
    }

    /// The highest local maxima of the gains.
    fn pick(&mut self) {
        self.found.clear();
        let columns = self.lengths.len();
        for row in 0..ANGLES {
            // A length at the end of the band says only that the blur is longer.
            for column in 0..columns - usize::from(columns > 1) {
                let gain = self.gains[row * columns + column];
                let neighbours = [ANGLES - 1, 0, 1].into_iter().flat_map(|turn| {
                    let row = (row + turn) % ANGLES;
                    (column.saturating_sub(1)..=(column + 1).min(columns - 1)).map(move |column| (row, column))
                });
                if gain <= 0.0 || neighbours.into_iter().any(|(r, c)| self.gains[r * columns + c] > gain) {
                    continue;
                }
                let gain = f64::from(gain);
                if self.found.len() == CANDIDATES {
                    if self.found.last().is_some_and(|worst| worst.gain >= gain) {
                        continue;
                    }
                    self.found.pop();
                }
                let angle = PI * row as f64 / ANGLES as f64;
                let place = self.found.partition_point(|other| other.gain >= gain);
                self.found.insert(place, Candidate { angle, length: self.lengths[column], gain });
            }
        }
    }
}

/// Sums that run side by side.
const SUMS: usize = 8;

/// Sum of the products of two columns of one length.
fn dot(a: &[f32], b: &[f32]) -> f32 {
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<SUMS>(), b.as_chunks::<SUMS>());
    let mut sums = [0.0_f32; SUMS];
    for (a, b) in a.iter().zip(b) {
        for ((sum, &a), &b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a * b;
        }
    }
    sums.iter().sum::<f32>() + a_rest.iter().zip(b_rest).map(|(&a, &b)| a * b).sum::<f32>()
}

/// Sum of the products of three columns of one length.
fn dot3(a: &[f32], b: &[f32], c: &[f32]) -> f32 {
    let ((a, a_rest), (b, b_rest), (c, c_rest)) = (a.as_chunks::<SUMS>(), b.as_chunks::<SUMS>(), c.as_chunks::<SUMS>());
    let mut sums = [0.0_f32; SUMS];
    for ((a, b), c) in a.iter().zip(b).zip(c) {
        for (((sum, &a), &b), &c) in sums.iter_mut().zip(a).zip(b).zip(c) {
            *sum += a * b * c;
        }
    }
    sums.iter().sum::<f32>() + a_rest.iter().zip(b_rest).zip(c_rest).map(|((&a, &b), &c)| a * b * c).sum::<f32>()
}

fn lengths(most_frequency: f64, range: LengthRange) -> Vec<f64> {
    let least = (LEAST_LINES / most_frequency).max(range.min_px());
    let most = (MOST_LINES / most_frequency).min(range.max_px());
    let mut lengths = Vec::new();
    let mut length = least;
    while length < most {
        lengths.push(length);
        length *= LENGTH_STEP;
    }
    lengths
}

/// Powers of all bins and their logarithms, with the noise power under them to keep bins without signal calm.
pub(super) fn log_powers(periodogram: &Periodogram, noise: f32, powers: &mut [f32], logs: &mut [f32]) {
    for ((power_out, log), power) in powers.iter_mut().zip(logs).zip(periodogram.powers()) {
        *power_out = power;
        *log = ln(power + noise);
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::Random;
    use super::*;
    use crate::image::Window;

    #[test]
    fn a_planted_pattern_is_the_first_candidate() {
        let range = LengthRange::new(4.0, 80.0).unwrap();
        for (rows, columns) in [(128, 128), (120, 161)] {
            let periodogram = Periodogram::new(rows, columns, Window::Hann);
            for most_frequency in [0.45, 0.225] {
                let mut band = Band::new(&periodogram, most_frequency, range).unwrap();
                for (seed, deg) in [0.0_f64, 30.7, 45.0, 90.0, 133.3, 179.0].into_iter().enumerate() {
                    for length in [9.0, 19.3] {
                        let mut random = Random::new(seed as u64);
                        let (sin, cos) = deg.to_radians().sin_cos();
                        // A scene that falls with the frequency and has a direction, and powers that scatter.
                        let powers: Vec<f32> = periodogram
                            .u
                            .iter()
                            .zip(&periodogram.v)
                            .map(|(&u, &v)| {
                                let (u, v) = (f64::from(u), f64::from(v));
                                let s = u * cos - v * sin;
                                let r2 = u * u + v * v;
                                let scene = (0.5 * (u * u - v * v) / r2).exp() / r2;
                                (scene * (sinc(length * s).powi(2) + 1e-2) * random.exponential()) as f32
                            })
                            .collect();
                        let logs: Vec<f32> = powers.iter().map(|&power| power.ln()).collect();
                        band.search(&powers, &logs, 1e-4);
                        let found = band.found[0];
                        let turn = (found.angle.to_degrees() - deg + 90.0).rem_euclid(180.0) - 90.0;
                        let miss = format!("{rows}x{columns} {most_frequency} {deg} deg {length} px: {found:?}");
                        // One step of the grid each way.
                        assert!(turn.abs() <= 180.0 / ANGLES as f64, "{miss}");
                        assert!((found.length / length).ln().abs() <= LENGTH_STEP.ln(), "{miss}");
                        assert!(band.covers(length), "{miss}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_constant_spectrum_has_no_candidate() {
        let periodogram = Periodogram::new(64, 64, Window::Hann);
        let mut band = Band::new(&periodogram, 0.45, LengthRange::new(4.0, 30.0).unwrap()).unwrap();
        let zeros = vec![0.0; periodogram.len()];
        band.search(&zeros, &zeros, 1.0);
        assert!(band.found.is_empty(), "{:?}", band.found);
    }

    #[test]
    fn a_band_without_lengths_of_the_range_is_none() {
        let periodogram = Periodogram::new(64, 64, Window::Hann);
        // Blurs of 4 to 5 pixels draw less than one line below 0.1 cycles per pixel.
        assert!(Band::new(&periodogram, 0.1, LengthRange::new(4.0, 5.0).unwrap()).is_none());
    }
}
