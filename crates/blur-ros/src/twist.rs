//! From a record to a velocity in the optical frame of the camera.

use blur_core::camera::LocalBlur;
use blur_core::estimate::AxialAngle;
use blur_core::meter::Geometry;
use blur_core::record::Record;

use crate::msg::{Header, TwistWithCovarianceStamped};

/// Variance of what a picture does not tell, in (m/s)^2 or (rad/s)^2: its mean is 0. A filter that is told to use those
/// entries all the same gains nothing from them; `robot_localization` is best told not to (`twist0_config`).
pub const UNKNOWN_VARIANCE: f64 = 1e6;

/// The places of x and y among the six rows of the covariance: linear x, y, z, angular x, y, z.
const LINEAR: [usize; 2] = [0, 1];
const ANGULAR: [usize; 2] = [3, 4];

/// The velocity that a record tells of; `None` without a speed or an angular rate.
///
/// The frame is that of ROS for cameras (REP 103): x to the right, y *down*, z forward. With a direction `d`, counter-clockwise
/// from the right as seen,
/// - what is seen moves with `linear.x = v cos d`, `linear.y = -v sin d` relative to the camera;
/// - a camera that turns before a scene at rest ([`Geometry::Rotation`]) does so with `angular.x = -w sin d`,
///   `angular.y = -w cos d`: turning right (about +y, which points down) moves what is seen to the left.
///
/// With the speed `v`, its standard uncertainty `s`, that of the direction `t` in radians and their covariance `c`, the
/// covariance of x and y is of first order (GUM 5.2.2) `J C J'`, with `J = [[cos d, -v sin d], [-sin d, -v cos d]]` and
/// `C = [[s^2, c], [c, t^2]]`. Scale and exposure err independently of the direction, so `c = (v / L) r u(L) t` with the correlation
/// `r` of length and direction. Where a method states no uncertainty, the variances are [`UNKNOWN_VARIANCE`].
///
/// A direction that is known but for its sign is given by the axis in `[0, 180)`. The truth is then one of two opposite
/// velocities, and the mean square error of giving either adds `2 x x'` with the velocity `x`: half of `(2 x)(2 x)'`.
///
/// Through a camera with a lens or pixels that are not square, `d` is the direction without these.
pub fn twist<'a>(
    header: Header<'a>,
    record: &Record,
    geometry: Option<&Geometry>,
) -> Option<TwistWithCovarianceStamped<'a>> {
    let turned = record.angular_rate_rad_s.map(|rate| (rate, record.angular_rate_std_rad_s));
    let (size, std) = turned.or_else(|| record.speed_m_s.map(|speed| (speed, record.speed_std_m_s)))?;
    let seen = Planar::new(size, std, direction_rad(record, geometry), record);
    let mut twist = TwistWithCovarianceStamped { header, linear: [0.0; 3], angular: [0.0; 3], covariance: [0.0; 36] };
    for place in 0..6 {
        twist.covariance[7 * place] = UNKNOWN_VARIANCE;
    }
    let Planar { velocity: [x, y], covariance: [[xx, xy], [_, yy]] } = seen;
    let (places, block) = if turned.is_some() {
        // What is seen at rest moves by x' = -w_y and y' = w_x in the middle of the picture.
        twist.angular = [y, -x, 0.0];
        (ANGULAR, [[yy, -xy], [-xy, xx]])
    } else {
        twist.linear = [x, y, 0.0];
        (LINEAR, [[xx, xy], [xy, yy]])
    };
    for (row, values) in places.into_iter().zip(block) {
        for (column, value) in places.into_iter().zip(values) {
            twist.covariance[6 * row + column] = value;
        }
    }
    Some(twist)
}

/// A velocity to the right and down with its covariance.
struct Planar {
    velocity: [f64; 2],
    covariance: [[f64; 2]; 2],
}

impl Planar {
    fn new(size: f64, std: Option<f64>, direction_rad: f64, record: &Record) -> Self {
        let (sin, cos) = direction_rad.sin_cos();
        let velocity @ [x, y] = [size * cos, -size * sin];
        let (Some(std), Some(angle_std_deg), Some(length_std_px)) = (std, record.angle_std_deg, record.length_std_px)
        else {
            return Self { velocity, covariance: [[UNKNOWN_VARIANCE, 0.0], [0.0, UNKNOWN_VARIANCE]] };
        };
        let angle_std = angle_std_deg.to_radians();
        let shared = record.correlation.unwrap_or(0.0) * size / record.length_px * length_std_px * angle_std;
        let by = [[cos, -size * sin], [-sin, -size * cos]];
        let of = [[std * std, shared], [shared, angle_std * angle_std]];
        let is_known = record.direction_deg.is_some();
        let covariance = std::array::from_fn(|row| {
            std::array::from_fn(|column| {
                let spread: f64 = (0..2)
                    .flat_map(|i| (0..2).map(move |j| (i, j)))
                    .map(|(i, j)| by[row][i] * of[i][j] * by[column][j])
                    .sum();
                spread + if is_known { 0.0 } else { 2.0 * [x, y][row] * [x, y][column] }
            })
        });
        Self { velocity, covariance }
    }
}

/// The direction of a record, or its axis, as it is without lens and with square pixels.
fn direction_rad(record: &Record, geometry: Option<&Geometry>) -> f64 {
    let stated_deg = record.direction_deg.unwrap_or(record.angle_deg);
    let Some(Geometry::Plane { camera, .. } | Geometry::Rotation { camera }) = geometry else {
        return stated_deg.to_radians();
    };
    let local = LocalBlur {
        centre_px: [0.5 * (record.width as f64 - 1.0), 0.5 * (record.height as f64 - 1.0)],
        angle: AxialAngle::from_deg(record.angle_deg),
        angle_std_deg: 0.0,
        length_px: record.length_px,
        length_std_px: 0.0,
        correlation: 0.0,
    };
    // It was possible for the speed; were it not here, the direction as seen is the best there is.
    let ideal = camera.resized(record.width, record.height).and_then(|camera| camera.ideal_blur(local));
    let axis_deg = ideal.map_or(record.angle_deg, |ideal| ideal.angle().deg());
    // A lens turns an axis by far less than a quarter, so the nearer of both senses is that of the direction.
    let is_opposite = record.direction_deg.is_some_and(|deg| (deg - axis_deg).to_radians().cos() < 0.0);
    (axis_deg + if is_opposite { 180.0 } else { 0.0 }).to_radians()
}
