use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng as _, SeedableRng as _};

/// Random numbers that are the same on every machine: `ChaCha8` and elementary functions of `libm`.
pub(super) struct Random {
    source: ChaCha8Rng,
    spare: Option<f64>,
}

impl Random {
    pub(super) fn new(seed: u64) -> Self {
        let mut key = [0; 32];
        key[..8].copy_from_slice(&seed.to_le_bytes());
        Self { source: ChaCha8Rng::from_seed(key), spare: None }
    }

    /// Uniform in (0, 1), both ends excluded.
    pub(super) fn uniform(&mut self) -> f64 {
        ((self.source.next_u64() >> 11) as f64 + 0.5) * 2.0_f64.powi(-53)
    }

    /// A point in the unit disk without its centre: one coordinate each, and the squared radius.
    fn disk(&mut self) -> (f64, f64, f64) {
        loop {
            let (x, y) = (2.0 * self.uniform() - 1.0, 2.0 * self.uniform() - 1.0);
            let w = x * x + y * y;
            if w > 0.0 && w < 1.0 {
                return (x, y, w);
            }
        }
    }

    /// Standard normal (Marsaglia's polar method).
    pub(super) fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        let (x, y, w) = self.disk();
        let scale = (-2.0 * libm::log(w) / w).sqrt();
        self.spare = Some(y * scale);
        x * scale
    }

    /// Student's t with `dof` degrees of freedom (Bailey, *Math. Comp.* 62 (1994) 779).
    pub(super) fn student_t(&mut self, dof: f64) -> f64 {
        if dof.is_infinite() {
            return self.normal();
        }
        let (x, _, w) = self.disk();
        let squared_radius = dof * libm::expm1(-2.0 / dof * libm::log(w));
        x * (squared_radius / w).sqrt()
    }
}
