//! A street: objects that move differently in front of a background that stands still.
//!
//! An opaque object that moves in front of a still background covers each pixel during a share of the exposure, its
//! opacity `A`, and lends it the light `C` in that time. With the matte `a` of the object (1 inside, 0 outside), its
//! texture `c` and the time average `E` along the path, `A = E[a]`, `C = E[a c]`, and the pixel shows
//!
//! `(1 - A) background + C`.
//!
//! This is exact, at soft borders too, as long as no two objects meet in a pixel: the time average of a product of two
//! mattes is not the product of their averages. Layouts in which they do are refused.

use crate::expose::Exposer;
use crate::motion::Motion;
use crate::rng::Rng;
use crate::{Error, Result, check};
use blur_core::estimate::AxialAngle;
use ndarray::{Array2, ArrayView2, Zip};

/// The matte falls from 1 to 0 over this many pixels, as a raised cosine: it is then nearly band-limited, as the
/// exposure takes it to be.
const MATTE_EDGE_PX: f64 = 3.0;
/// Opacity from which a pixel belongs to an object.
const HALF: f64 = 0.5;
/// Opacity that counts as none: what is left of the ringing of a matte.
const NO_OPACITY: f64 = 0.02;
/// Stream of the seed for random layouts.
const LAYOUT_STREAM: u64 = 0x57ee_0001;

/// The outline of an object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// A rectangle whose corners are rounded by `radius_px`, at most half its shorter side.
    RoundedBox {
        /// Radius of the corners in pixels.
        radius_px: f64,
    },
    /// An ellipse.
    Ellipse,
}

/// One moving object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mover {
    /// Its outline.
    pub shape: Shape,
    /// Column of its centre in the middle of the exposure.
    pub centre_x: f64,
    /// Row of its centre in the middle of the exposure.
    pub centre_y: f64,
    /// Columns that it covers.
    pub width_px: f64,
    /// Rows that it covers.
    pub height_px: f64,
    /// How it moves.
    pub motion: Motion,
}

/// What the sensor saw, and where.
#[derive(Debug, Clone, PartialEq)]
pub struct Exposure {
    /// Light on the scale of the textures.
    pub light: Array2<f64>,
    /// 0 where the background is seen for more than half the exposure, `i` where object number `i`, from 1, is.
    pub labels: Array2<u8>,
}

impl Mover {
    /// Opacity of the object at rest, 0 to 1, at `(x, y)` in columns and rows.
    pub fn matte(&self, x: f64, y: f64) -> f64 {
        let (x, y) = ((x - self.centre_x).abs(), (y - self.centre_y).abs());
        let (half_width, half_height) = (0.5 * self.width_px, 0.5 * self.height_px);
        let outside_px = match self.shape {
            Shape::RoundedBox { radius_px } => {
                let radius = radius_px.min(half_width).min(half_height);
                let (dx, dy) = (x - half_width + radius, y - half_height + radius);
                dx.max(0.0).hypot(dy.max(0.0)) + dx.max(dy).min(0.0) - radius
            }
            Shape::Ellipse => {
                // First order in the distance, which is all that the narrow edge needs.
                let (p, q) = (x / half_width, y / half_height);
                let level = p.hypot(q);
                let slope = (p / half_width).hypot(q / half_height);
                if slope > 0.0 { (level - 1.0) * level / slope } else { -half_width.min(half_height) }
            }
        };
        let along = (0.5 - outside_px / MATTE_EDGE_PX).clamp(0.0, 1.0);
        0.5 - 0.5 * libm::cos(std::f64::consts::PI * along)
    }
}

/// Exposes `background` (rows x columns, any linear scale) with the `movers`, each with its texture: a picture of the
/// background's size, of which the object shows the part that it covers.
///
/// # Errors
/// [`Error::StreetSize`] for a texture of another size, [`Error::MoversMeet`] when objects meet in a pixel,
/// [`Error::Parameter`] for more than 255 objects; those of [`Exposer::expose_padded`] otherwise.
pub fn expose_street(background: ArrayView2<'_, f64>, movers: &[(Mover, ArrayView2<'_, f64>)]) -> Result<Exposure> {
    let (rows, cols) = background.dim();
    check::size(rows, cols)?;
    check::finite(background)?;
    check::range("number of moving objects", movers.len() as f64, 0.0, 255.0, "0 to 255")?;
    let mut exposer = Exposer::new();
    let mut light = background.to_owned();
    let mut labels = Array2::zeros((rows, cols));
    let mut covered = Array2::<f64>::zeros((rows, cols));
    for (number, (mover, texture)) in movers.iter().enumerate() {
        if texture.dim() != (rows, cols) {
            let (other_rows, other_cols) = texture.dim();
            return Err(Error::StreetSize { rows, cols, other_rows, other_cols });
        }
        let matte = Array2::from_shape_fn((rows, cols), |(row, col)| mover.matte(col as f64, row as f64));
        let opacity = exposer.expose_padded(matte.view(), &mover.motion)?;
        let seen = exposer.expose_padded((&matte * texture).view(), &mover.motion)?;
        let meeting = covered.indexed_iter().zip(&opacity).find(|((_, before), now)| before.min(**now) > NO_OPACITY);
        if let Some((((row, col), _), _)) = meeting {
            return Err(Error::MoversMeet { row, col });
        }
        Zip::from(&mut light).and(&background).and(&opacity).and(&seen).for_each(|light, &still, &opacity, &seen| {
            *light += seen - opacity * still;
        });
        Zip::from(&mut labels).and(&opacity).for_each(|label, &opacity| {
            if opacity > HALF {
                *label = number as u8 + 1;
            }
        });
        covered += &opacity;
    }
    Ok(Exposure { light, labels })
}

/// Two objects side by side in a picture of `rows` x `cols` pixels, by chance but for the seed: a rounded box and an
/// ellipse of 150 to 300 pixels each way, blurred by 12 to 40 pixels in directions at least 30 degrees apart.
///
/// # Errors
/// [`Error::SceneTooSmall`] when the picture has less than 368 rows or 736 columns, which both need with their motion.
pub fn two_movers(seed: u64, rows: usize, cols: usize) -> Result<[Mover; 2]> {
    const SIDES_PX: (f64, f64) = (150.0, 300.0);
    const LENGTHS_PX: (f64, f64) = (12.0, 40.0);
    const APART_DEG: f64 = 30.0;
    // The longest motion reaches half its length beyond the object; the matte's edge and the border need the rest.
    const MARGIN_PX: f64 = 0.5 * LENGTHS_PX.1 + 14.0;
    const HALF_COLS: usize = (SIDES_PX.1 + 2.0 * MARGIN_PX) as usize;
    check::size(rows, cols)?;
    if rows < HALF_COLS || cols < 2 * HALF_COLS {
        return Err(Error::SceneTooSmall { rows, cols, need_rows: HALF_COLS, need_cols: 2 * HALF_COLS });
    }
    let mut rng = Rng::new(seed, LAYOUT_STREAM);
    let half = 0.5 * cols as f64;
    let first_deg = rng.uniform_in(0.0, 180.0);
    let second_deg = first_deg + rng.uniform_in(APART_DEG, 180.0 - APART_DEG);
    let mut place = |left: f64, shape: Shape, deg: f64| -> Result<Mover> {
        let mut side = || rng.uniform_in(SIDES_PX.0, SIDES_PX.1);
        let (width_px, height_px) = (side(), side());
        let (free_x, free_y) = (half - width_px - 2.0 * MARGIN_PX, rows as f64 - height_px - 2.0 * MARGIN_PX);
        Ok(Mover {
            shape,
            centre_x: left + MARGIN_PX + 0.5 * width_px + free_x * rng.uniform(),
            centre_y: MARGIN_PX + 0.5 * height_px + free_y * rng.uniform(),
            width_px,
            height_px,
            motion: Motion::uniform(rng.uniform_in(LENGTHS_PX.0, LENGTHS_PX.1), AxialAngle::from_deg(deg))?,
        })
    };
    Ok([place(0.0, Shape::RoundedBox { radius_px: 25.0 }, first_deg)?, place(half, Shape::Ellipse, second_deg)?])
}
