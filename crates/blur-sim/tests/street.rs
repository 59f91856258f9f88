//! The light of a street is that of its layers, in closed form.
#![allow(clippy::unwrap_used)]

use blur_core::estimate::AxialAngle;
use blur_sim::Error;
use blur_sim::motion::Motion;
use blur_sim::scene::{DeadLeaves, dead_leaves};
use blur_sim::street::{Mover, Shape, expose_street, two_movers};
use ndarray::Array2;

fn mover(shape: Shape, centre_x: f64, length_px: f64, deg: f64) -> Mover {
    let motion = Motion::uniform(length_px, AxialAngle::from_deg(deg)).unwrap();
    Mover { shape, centre_x, centre_y: 100.0, width_px: 80.0, height_px: 60.0, motion }
}

#[test]
fn the_border_of_a_moving_object_is_a_ramp_as_long_as_its_blur() {
    let object = mover(Shape::RoundedBox { radius_px: 10.0 }, 150.0, 24.0, 0.0);
    let (still, texture) = (Array2::from_elem((200, 300), 40.0), Array2::from_elem((200, 300), 200.0));
    let street = expose_street(still.view(), &[(object, texture.view())]).unwrap();
    for col in 0..300 {
        // Half width 40: the share of the exposure in which the box covers the pixel.
        let opacity = ((52.0 - (col as f64 - 150.0).abs()) / 24.0).clamp(0.0, 1.0);
        let found = (street.light[(100, col)] - 40.0) / 160.0;
        // The matte's own edge of 3 pixels rounds the corners of the ramp by less than 3 / 8 / 24.
        assert!((found - opacity).abs() < 0.016, "{col}: {found} {opacity}");
        assert_eq!(street.labels[(100, col)], u8::from((col as f64 - 150.0).abs() < 40.0 || found > 0.5));
    }
}

#[test]
fn a_motion_takes_no_light_away() {
    for shape in [Shape::RoundedBox { radius_px: 15.0 }, Shape::Ellipse] {
        let object = mover(shape, 150.0, 31.0, 33.0);
        let (still, texture) = (Array2::zeros((200, 300)), Array2::from_elem((200, 300), 1.0));
        let street = expose_street(still.view(), &[(object, texture.view())]).unwrap();
        let area = match shape {
            // Corners of a box of radius r lack (4 - pi) r^2.
            Shape::RoundedBox { radius_px } => 80.0 * 60.0 - (4.0 - std::f64::consts::PI) * radius_px * radius_px,
            Shape::Ellipse => std::f64::consts::PI * 40.0 * 30.0,
        };
        assert!((street.light.sum() / area - 1.0).abs() < 0.002, "{shape:?}: {} {area}", street.light.sum());
    }
}

#[test]
fn far_from_objects_the_background_is_seen_and_well_inside_them_their_blurred_texture() {
    let object = mover(Shape::Ellipse, 150.0, 12.0, 70.0);
    let still = dead_leaves(3, 200, 300, &DeadLeaves::default()).unwrap();
    let texture = dead_leaves(4, 200, 300, &DeadLeaves::default()).unwrap();
    let street = expose_street(still.view(), &[(object, texture.view())]).unwrap();
    let blurred = blur_sim::expose::expose_padded(texture.view(), &object.motion).unwrap();
    assert!((street.light[(20, 30)] - still[(20, 30)]).abs() < 0.1);
    assert!((street.light[(100, 150)] - blurred[(100, 150)]).abs() < 0.5);
}

#[test]
fn objects_that_meet_and_textures_that_do_not_fit_are_refused() {
    let (still, small) = (Array2::<f64>::zeros((200, 300)), Array2::<f64>::zeros((200, 299)));
    let at = |x: f64| mover(Shape::Ellipse, x, 20.0, 0.0);
    let met = expose_street(still.view(), &[(at(100.0), still.view()), (at(190.0), still.view())]);
    assert!(matches!(met, Err(Error::MoversMeet { .. })), "{met:?}");
    assert!(expose_street(still.view(), &[(at(80.0), still.view()), (at(210.0), still.view())]).is_ok());
    let size = expose_street(still.view(), &[(at(100.0), small.view())]);
    assert!(matches!(size, Err(Error::StreetSize { .. })), "{size:?}");
    assert!(matches!(two_movers(1, 300, 768), Err(Error::SceneTooSmall { .. })));
}

#[test]
fn two_movers_are_as_they_are_said_to_be_and_never_meet() {
    let still = Array2::<f64>::zeros((512, 768));
    for seed in 0..12 {
        let [a, b] = two_movers(seed, 512, 768).unwrap();
        assert!(expose_street(still.view(), &[(a, still.view()), (b, still.view())]).is_ok(), "{seed}: {a:?} {b:?}");
        assert!(a.motion.angle().distance_deg(b.motion.angle()) >= 30.0);
        for object in [a, b] {
            assert!((150.0..300.0).contains(&object.width_px) && (150.0..300.0).contains(&object.height_px));
            assert!((12.0..40.0).contains(&object.motion.length_px()));
        }
    }
}
