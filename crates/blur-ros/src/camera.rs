//! From `CameraInfo` to a calibrated camera.

use blur_core::camera::{Intrinsics, PARAMETERS};

use crate::msg::CameraInfo;
use crate::{Error, Result};

/// The camera that took the pictures of a topic.
///
/// Pictures as taken follow the matrix `K` and the lens `plumb_bob` of `D` (`k1 k2 p1 p2 k3`, the model of
/// [`Intrinsics`]); `rectified` ones follow `P` without a lens. `CameraInfo` tells no uncertainties: the camera counts as
/// exact. It is that of the whole sensor; pictures of binned pixels are taken as resampled.
///
/// # Errors
/// [`Error::CameraInfo`] for a camera that is not calibrated, another lens or a part of the sensor, and those of
/// [`Intrinsics::new`].
pub fn intrinsics(info: &CameraInfo<'_>, rectified: bool) -> Result<Intrinsics> {
    let refused = |reason: String| Err(Error::CameraInfo { reason });
    let (width, height, roi) = (info.width, info.height, info.roi);
    if info.k[0] == 0.0 {
        return refused("the camera is not calibrated: K[0] is 0".to_owned());
    }
    let is_whole = (roi.width == 0 && roi.height == 0)
        || (roi.x_offset == 0 && roi.y_offset == 0 && roi.width == width && roi.height == height);
    if !is_whole {
        let (w, h) = (roi.width, roi.height);
        return refused(format!("it tells of a part of {w}x{h} pixels of the sensor, only the whole can be used"));
    }
    let mut parameters = [0.0; PARAMETERS];
    if rectified {
        let [fx, skew, cx, _, _, fy, cy, ..] = info.p;
        parameters[..5].copy_from_slice(&[fx, fy, cx, cy, skew]);
    } else {
        let [fx, skew, cx, _, fy, cy, ..] = info.k;
        parameters[..5].copy_from_slice(&[fx, fy, cx, cy, skew]);
        let lens = &mut parameters[5..];
        // Models with more coefficients are this one where those are 0, and without any there is no lens.
        let has_other_lens = !info.d.iter().skip(lens.len()).all(|&coefficient| coefficient == 0.0);
        let is_known = ["plumb_bob", "rational_polynomial"].contains(&info.distortion_model);
        if has_other_lens || !(is_known || info.d.iter().all(|&coefficient| coefficient == 0.0)) {
            return refused(format!(
                "its lens is '{}' with {} coefficients, only plumb_bob with 5 is known: rectify the pictures",
                info.distortion_model,
                info.d.len()
            ));
        }
        for (parameter, &coefficient) in lens.iter_mut().zip(&info.d) {
            *parameter = coefficient;
        }
    }
    Ok(Intrinsics::new(parameters, [[0.0; PARAMETERS]; PARAMETERS], width as usize, height as usize)?)
}

/// The topic on which the `CameraInfo` of the pictures of `topic` is published by convention: `camera_info` beside it, or
/// beside the raw topic of `image_transport` where it is compressed.
pub fn info_topic(topic: &str) -> String {
    let namespace =
        topic.strip_suffix("/compressed").unwrap_or(topic).rsplit_once('/').map_or("", |(namespace, _)| namespace);
    format!("{namespace}/camera_info")
}

/// Whether the pictures of a topic are rectified, by the names of `image_proc`.
pub fn is_rectified(topic: &str) -> bool {
    topic.rsplit('/').any(|part| part.starts_with("image_rect"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::msg::RegionOfInterest;

    fn info() -> CameraInfo<'static> {
        CameraInfo {
            height: 480,
            width: 640,
            distortion_model: "plumb_bob",
            d: vec![-0.2, 0.05, 0.001, -0.002, 0.003],
            k: [500.0, 0.0, 320.0, 0.0, 510.0, 240.0, 0.0, 0.0, 1.0],
            p: [450.0, 0.0, 310.0, 0.0, 0.0, 455.0, 235.0, 0.0, 0.0, 0.0, 1.0, 0.0],
            ..CameraInfo::default()
        }
    }

    #[test]
    fn points_are_seen_where_the_documented_model_sees_them() {
        let camera = intrinsics(&info(), false).unwrap();
        // The plumb bob of CameraInfo.msg, by hand at (0.2, -0.1).
        let (x, y) = (0.2_f64, -0.1_f64);
        let r2 = x * x + y * y;
        let radial = 1.0 - 0.2 * r2 + 0.05 * r2 * r2 + 0.003 * r2 * r2 * r2;
        let u = 500.0 * (x * radial + 2.0 * 0.001 * x * y - 0.002 * (r2 + 2.0 * x * x)) + 320.0;
        let v = 510.0 * (y * radial + 0.001 * (r2 + 2.0 * y * y) - 2.0 * 0.002 * x * y) + 240.0;
        let [found_u, found_v] = camera.project([0.4, -0.2, 2.0]).unwrap();
        assert!((found_u - u).abs() < 1e-9 && (found_v - v).abs() < 1e-9);
        let [u, v] = intrinsics(&info(), true).unwrap().project([0.4, -0.2, 2.0]).unwrap();
        assert!((u - 400.0).abs() < 1e-9 && (v - 189.5).abs() < 1e-9);
    }

    #[test]
    fn cameras_that_would_be_misread_are_refused() {
        let roi = RegionOfInterest { x_offset: 10, width: 100, height: 100, ..RegionOfInterest::default() };
        let other = vec![0.1, 0.0, 0.0, 0.0, 0.0, 0.3];
        for (info, word) in [
            (CameraInfo { k: [0.0; 9], ..info() }, "calibrated"),
            (CameraInfo { roi, ..info() }, "100x100"),
            (CameraInfo { distortion_model: "equidistant", ..info() }, "equidistant"),
            (CameraInfo { distortion_model: "rational_polynomial", d: other, ..info() }, "rational"),
        ] {
            let message = intrinsics(&info, false).unwrap_err().to_string();
            assert!(message.contains(word), "{message}");
        }
        assert!(intrinsics(&CameraInfo { distortion_model: "", d: vec![], ..info() }, false).is_ok());
    }

    #[test]
    fn the_camera_is_found_beside_its_pictures() {
        assert_eq!(info_topic("/camera/image_raw"), "/camera/camera_info");
        assert_eq!(info_topic("/camera/image_raw/compressed"), "/camera/camera_info");
        assert_eq!(info_topic("/image"), "/camera_info");
        assert!(is_rectified("/camera/image_rect/compressed") && !is_rectified("/camera/image_raw"));
    }
}
