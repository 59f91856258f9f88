//! Pictures of known acceleration, measured in every way.

use std::path::Path;

use blur_accel::homomorphic::{HomomorphicPsf, Prototype, Variant};
use blur_accel::model::Features;
use blur_core::camera::Scale;
use blur_core::estimate::joint::{Reference, Whittle};
use blur_core::estimate::{JointEstimator, MotionBlur, Settings, Status};
use blur_core::motion::{AcceleratedPath, Exposure, PathAcceleration};
use blur_sim::rig::{Design, POSTERS, Rig, STILLS, Studio};
use blur_sim::sensor::f32_from_u8;
use metrology::Measurement;
use ndarray::{Array1, Array2, ArrayView2};
use rayon::prelude::*;

use super::collection::{Collection, Scene};
use super::features::{first_size, read_luma, read_stills};
use crate::{Error, Result};

/// Pictures of known acceleration and what each method makes of them, in the order of the pictures.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// The homomorphic PSFs, one picture a row.
    pub inputs: Array2<f64>,
    /// True accelerations in m/s².
    pub targets: Array1<f64>,
    /// Number of the scene of each picture.
    pub scenes: Vec<usize>,
    /// Blur lengths in pixels as `whittle` measures them.
    pub lengths_px: Array1<f64>,
    /// From the picture alone; `None` without exposure and scale, or when the method does not call its answer `ok`.
    pub blind: Vec<Option<Physical>>,
    /// From the picture and the stills of its scene, positive for a motion that speeds up; `None` as for `blind`, and
    /// when the direction is not known.
    pub reference: Vec<Option<Physical>>,
}

/// An acceleration from physics alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Physical {
    /// With its standard uncertainty, in m/s²; without a sign where that is not known.
    pub acceleration: PathAcceleration,
    /// Whether it stands out from none.
    pub detected: bool,
}

/// The camera, as far as it is known.
#[derive(Debug, Clone, Copy)]
struct Camera {
    scale: Scale,
    exposure: Exposure,
}

impl Camera {
    fn of(scale_m_per_px: Option<f64>, exposure_s: Option<f64>) -> Result<Option<Self>> {
        let (Some(scale), Some(exposure)) = (scale_m_per_px, exposure_s) else { return Ok(None) };
        let scale = Scale::new(Measurement::exact(scale)?)?;
        Ok(Some(Self { scale, exposure: Exposure::new(Measurement::exact(exposure)?)? }))
    }

    fn acceleration(&self, found: &MotionBlur) -> Result<Option<Physical>> {
        let (Some(acceleration), Some(length_std_px), Status::Ok) =
            (found.acceleration, found.length_std_px, found.status)
        else {
            return Ok(None);
        };
        // A sign along an axis does not say whether the motion sped up.
        if acceleration.signed.is_some() && found.direction_deg.is_none() {
            return Ok(None);
        }
        let (ratio, correlation) = match acceleration.signed {
            Some(signed) => (signed.ratio, signed.length_correlation),
            None => (acceleration.ratio, acceleration.length_correlation),
        };
        let path = AcceleratedPath {
            ratio: Measurement::new(ratio, acceleration.ratio_std)?,
            length_px: Measurement::new(found.length_px, length_std_px)?,
            correlation,
        };
        let acceleration_m_s2 = PathAcceleration::from_blur(&path, self.scale, self.exposure);
        Ok(Some(Physical { acceleration: acceleration_m_s2, detected: acceleration.is_detected() }))
    }
}

/// The methods, made ready for the pictures of one scene.
struct Bench {
    extractor: HomomorphicPsf,
    prototype: Prototype,
    blind: Whittle,
    reference: Reference,
}

/// What they found in one picture.
struct Found {
    psf: Vec<f64>,
    length_px: f64,
    blind: Option<Physical>,
    reference: Option<Physical>,
}

impl Bench {
    fn new(features: &Features, stills: &[Array2<f32>]) -> Result<Self> {
        let views: Vec<ArrayView2<'_, f32>> = stills.iter().map(Array2::view).collect();
        let mut settings = Settings::default();
        settings.acceleration = true;
        Ok(Self {
            prototype: features.prototype(&views)?,
            extractor: features.extractor(),
            blind: Whittle::new(&settings),
            reference: Reference::new(&views, &settings)?,
        })
    }

    fn measure(&mut self, picture: ArrayView2<'_, f32>, camera: Option<Camera>) -> Result<Found> {
        let psf = self.extractor.extract(picture, &self.prototype)?.to_vec();
        let blind = self.blind.estimate(picture)?;
        let reference = self.reference.estimate(picture)?;
        let metric = |found: &MotionBlur| camera.map_or(Ok(None), |camera| camera.acceleration(found));
        Ok(Found { psf, length_px: blind.length_px, blind: metric(&blind)?, reference: metric(&reference)? })
    }
}

impl Study {
    /// Measures the pictures of a [folder](super::collection), all of one size, on the threads of the current pool.
    ///
    /// # Errors
    /// Those of [`Collection::read`], and [`Error::InFile`] with the path of a picture that is refused,
    /// [`Error::InScene`] for stills that do not go together, [`Error::NoBlurred`] when there is nothing to measure.
    pub fn read(folder: &Path, variant: Variant) -> Result<Self> {
        let collection = Collection::read(folder)?;
        let Some((height_px, width_px)) = first_size(&collection)? else { return Err(Error::NoBlurred) };
        let features = Features { variant, height_px, width_px };
        let per_scene: Vec<Vec<(usize, f64, Found)>> = (0..collection.scenes.len())
            .into_par_iter()
            .map(|scene| {
                let of_scene =
                    || collection.blurred.iter().enumerate().filter(move |(_, blurred)| blurred.scene == scene);
                if of_scene().next().is_none() {
                    return Ok(Vec::new());
                }
                let Scene { name, stills } = &collection.scenes[scene];
                let mut bench = read_stills(&features, stills)
                    .and_then(|lumas| Bench::new(&features, &lumas))
                    .map_err(|error| Error::InScene { scene: name.clone(), source: Box::new(error) })?;
                of_scene()
                    .map(|(row, blurred)| {
                        let found = Camera::of(blurred.scale_m_per_px, blurred.exposure_s)
                            .and_then(|camera| bench.measure(read_luma(&blurred.path)?.view(), camera))
                            .map_err(|error| error.in_file(&blurred.path))?;
                        Ok((row, blurred.accel_m_s2, found))
                    })
                    .collect()
            })
            .collect::<Result<_>>()?;
        Ok(Self::of(per_scene))
    }

    /// Takes one picture in `step` on a rig and measures it, on the threads of the current pool.
    ///
    /// # Errors
    /// [`Error::Rig`] for what the rig refuses.
    pub fn simulate(rig: &Rig, design: Design, seed: u64, step: usize) -> Result<Self> {
        let shots: Vec<_> = rig.shots(design, seed)?.into_iter().step_by(step.max(1)).collect();
        let studio = Studio::new(rig)?;
        let camera = Camera::of(Some(rig.scale_m_per_px), Some(rig.exposure_s))?;
        let features = Features { variant: Variant::default(), height_px: rig.side_px, width_px: rig.side_px };
        let per_scene: Vec<Vec<(usize, f64, Found)>> = (0..POSTERS.len())
            .into_par_iter()
            .map(|poster| {
                let mut studio = studio.clone();
                let stills = (0..STILLS)
                    .map(|index| Ok(f32_from_u8(studio.background(&rig.still(poster, index, seed)?)?.view())))
                    .collect::<Result<Vec<_>>>()?;
                let mut bench = Bench::new(&features, &stills)?;
                let of_poster = shots.iter().enumerate().filter(|(_, shot)| shot.poster == poster);
                of_poster
                    .map(|(row, shot)| {
                        let picture = f32_from_u8(studio.picture(shot)?.view());
                        Ok((row, shot.accel_m_s2, bench.measure(picture.view(), camera)?))
                    })
                    .collect()
            })
            .collect::<Result<_>>()?;
        Ok(Self::of(per_scene))
    }

    /// From the pictures of each scene with their numbers and accelerations.
    fn of(per_scene: Vec<Vec<(usize, f64, Found)>>) -> Self {
        let mut pictures: Vec<(usize, usize, f64, Found)> = per_scene
            .into_iter()
            .enumerate()
            .flat_map(|(scene, found)| found.into_iter().map(move |(row, target, found)| (row, scene, target, found)))
            .collect();
        pictures.sort_by_key(|(row, ..)| *row);
        let columns = pictures.first().map_or(0, |(.., found)| found.psf.len());
        let mut inputs = Array2::zeros((pictures.len(), columns));
        for (mut row, (.., found)) in inputs.rows_mut().into_iter().zip(&pictures) {
            row.iter_mut().zip(&found.psf).for_each(|(to, &from)| *to = from);
        }
        Self {
            inputs,
            targets: pictures.iter().map(|(_, _, target, _)| *target).collect(),
            scenes: pictures.iter().map(|(_, scene, ..)| *scene).collect(),
            lengths_px: pictures.iter().map(|(.., found)| found.length_px).collect(),
            blind: pictures.iter().map(|(.., found)| found.blind).collect(),
            reference: pictures.iter().map(|(.., found)| found.reference).collect(),
        }
    }

    /// Pictures.
    pub fn len(&self) -> usize {
        self.targets.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.targets.is_empty()
    }
}
