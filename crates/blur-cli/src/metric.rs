//! From pixels to metres and seconds: what the blur about one place of a picture was in the scene.

use blur_core::camera::Scale;
use blur_core::estimate::{AxialAngle, MotionBlur, Status};
use blur_core::image::Window;
use blur_core::motion::{
    AcceleratedPath, Exposure, PathAcceleration, RolledBlur, RolledSpeed, RollingShutter, Speed, SpeedChange,
    TileMotion,
};
use metrology::Measurement;

use crate::Result;
use crate::camera::seen::{self, SeenBlur};
use crate::map::Map;
use crate::measure::Options;
use crate::picture::Picture;
use crate::record::{
    AccelerationFields, AngularRate, CameraFields, ChangeFields, ExposureSource, NoSpeed, ReadoutFields,
    RolledSpeedFields,
};

/// What is known of how a picture was taken.
pub struct Metric<'a> {
    options: &'a Options,
    picture: &'a Picture,
    exposure: Option<(Exposure, ExposureSource)>,
}

/// What is known about one place of a picture.
pub struct Place {
    /// The blur as the camera saw it there.
    seen: Option<SeenBlur>,
    /// The scale there.
    scale: Option<Scale>,
}

impl Place {
    /// What is worth knowing about the camera.
    pub fn note(&self) -> Option<String> {
        self.seen.as_ref().and_then(|seen| seen.note.clone())
    }
}

impl<'a> Metric<'a> {
    /// For `picture`, with its exposure from the options or from its EXIF data.
    pub fn new(options: &'a Options, picture: &'a Picture) -> Result<Self> {
        let stated = match (options.exposure_s, picture.exif.exposure_s) {
            (Some(seconds), _) => Some((seconds, ExposureSource::Option)),
            (None, Some(seconds)) => Some((seconds, ExposureSource::Exif)),
            (None, None) => None,
        };
        let exposure = match stated {
            Some((seconds, source)) => {
                Some((Exposure::new(Measurement::new(seconds, options.exposure_std_s)?)?, source))
            }
            None => None,
        };
        Ok(Self { options, picture, exposure })
    }

    /// The exposure, and who says so.
    pub fn exposure(&self) -> Option<(Exposure, ExposureSource)> {
        self.exposure
    }

    /// What is known about a blur measured about `centre_px`, column and row of the picture.
    ///
    /// # Errors
    /// Those of [`seen::seen`].
    pub fn place(&self, blur: &MotionBlur, centre_px: [f64; 2]) -> Result<Place> {
        let options = self.options;
        let is_asked = options.camera.is_some() || options.rotating;
        let seen = match blur.status {
            Status::NoMotionBlur(_) => None,
            _ if !is_asked => None,
            _ => seen::seen(options.camera.as_ref(), self.picture, centre_px, blur)?,
        };
        let scale = match (&seen, options.distance_m) {
            (Some(seen), Some(distance_m)) => Some(seen.ideal.scale(distance_m)?),
            _ => options.scale,
        };
        Ok(Place { seen, scale })
    }

    /// The speed of a blur, or why there is none; neither where nobody asks for one.
    pub fn speed(&self, blur: &MotionBlur, place: &Place) -> (Option<Speed>, Option<NoSpeed>) {
        let no_blur = matches!(blur.status, Status::NoMotionBlur(_));
        let (scale, exposure) = (place.scale, self.exposure_alone());
        if let (Some(scale), Some(exposure), false) = (scale, exposure, no_blur) {
            return (Some(Speed::from_blur(blur.length_px, blur.length_std_px, scale, exposure)), None);
        }
        let (has_camera, rotating) = (self.options.camera.is_some(), self.options.rotating);
        let missing = if no_blur && (has_camera || rotating || (scale.is_some() && exposure.is_some())) {
            NoSpeed::NoMotionBlur
        } else if rotating && place.seen.is_none() {
            NoSpeed::FocalLengthMissing
        } else if exposure.is_none() && (scale.is_some() || rotating) {
            NoSpeed::ExposureMissing
        } else if rotating {
            return (None, None);
        } else if has_camera {
            NoSpeed::DistanceMissing
        } else if exposure.is_some() {
            NoSpeed::ScaleMissing
        } else {
            return (None, None);
        };
        (None, Some(missing))
    }

    /// The acceleration that was found, if any.
    pub fn acceleration(&self, blur: &MotionBlur, place: &Place) -> Result<Option<AccelerationFields>> {
        // Without a blur there is nothing that could accelerate.
        let Some(found) = blur.acceleration.filter(|_| !matches!(blur.status, Status::NoMotionBlur(_))) else {
            return Ok(None);
        };
        let length_px = Measurement::new(blur.length_px, blur.length_std_px.unwrap_or(0.0))?;
        let to_metric = place.scale.zip(self.exposure_alone()).map(|(scale, exposure)| {
            move |ratio: f64, std: f64| -> Result<PathAcceleration> {
                let ratio = Measurement::new(ratio, std)?;
                let path = AcceleratedPath {
                    ratio,
                    length_px,
                    correlation: found.signed.map_or(found.length_correlation, |signed| signed.length_correlation),
                };
                Ok(PathAcceleration::from_blur(&path, scale, exposure))
            }
        });
        AccelerationFields::new(found, to_metric).map(Some)
    }

    /// What the camera adds: the blur without distortion, its scale, how fast it turned.
    pub fn camera(&self, blur: &MotionBlur, place: &Place) -> Result<Option<CameraFields>> {
        let Some(seen) = &place.seen else { return Ok(None) };
        let mut fields = CameraFields::new(seen, place.scale)?;
        if let Some(exposure) = self.exposure_alone().filter(|_| self.options.rotating) {
            fields.rate = Some(AngularRate::new(seen.ideal.turn_rad()?, blur.length_std_px.is_some(), exposure));
        }
        Ok(Some(fields))
    }

    /// The speeds downwards and upwards that the readout of the sensor allows, when the options tell it.
    pub fn rolled(&self, blur: &MotionBlur, place: &Place) -> Result<Option<[RolledSpeed; 2]>> {
        let Some(shutter) = self.shutter()? else { return Ok(None) };
        let has_blur = !matches!(blur.status, Status::NoMotionBlur(_));
        let known = place.scale.zip(self.exposure_alone()).filter(|_| has_blur);
        let blur = self.stored_blur(blur);
        Ok(known.map(|(scale, exposure)| {
            [shutter.speed_downwards(&blur, scale, exposure), shutter.speed_upwards(&blur, scale, exposure)]
        }))
    }

    /// What the readout of the sensor does to the speed, when the options tell it; `map` is of the part of the picture
    /// whose top left pixel is `origin`.
    pub fn readout(
        &self,
        blur: &MotionBlur,
        place: &Place,
        map: Option<&Map>,
        origin: (usize, usize),
    ) -> Result<Option<ReadoutFields>> {
        let (Some(readout_s), Some(shutter)) = (self.options.readout_s, self.shutter()?) else { return Ok(None) };
        let (change, change_reason) = match map.map(|map| self.change(shutter, map, origin)) {
            None => (None, None),
            Some(Ok(change)) => (Some(ChangeFields::new(change, place.scale)), None),
            Some(Err(reason)) => (None, Some(reason)),
        };
        Ok(Some(ReadoutFields {
            readout_s,
            rows_run: self.picture.stored_frame().rows_run(),
            speeds: self.rolled(blur, place)?.map(RolledSpeedFields::new).unwrap_or_default(),
            change,
            change_reason,
        }))
    }

    /// The change of the speed over the tiles that move, or why there is none.
    fn change(
        &self,
        shutter: RollingShutter,
        map: &Map,
        origin: (usize, usize),
    ) -> std::result::Result<SpeedChange, String> {
        let exposure = self.exposure_alone().ok_or("the exposure is not known")?;
        let count = |is_asked: fn(Status) -> bool| {
            map.tiles.iter().filter(|tile| tile.blur.is_some_and(|blur| is_asked(blur.status))).count()
        };
        let moving = count(|status| status == Status::Ok);
        let still = count(|status| matches!(status, Status::NoMotionBlur(_)));
        // Where most of the picture moves, it was the camera, whose motion may well differ from part to part.
        if map.segmentation.moving.len() > 1 && still >= moving {
            return Err(format!("{} regions move before a still background, not one", map.segmentation.moving.len()));
        }
        let frame = self.picture.stored_frame();
        let tiles: Vec<TileMotion> = map
            .tiles
            .iter()
            .filter_map(|tile| {
                let blur = tile.blur.filter(|blur| blur.status == Status::Ok)?;
                let (x, y) = tile.centre();
                let centre_px = frame.stored([x + origin.0 as f64, y + origin.1 as f64]);
                Some(TileMotion { centre_px, blur: self.stored_blur(&blur) })
            })
            .collect();
        let window = self.options.settings.window.unwrap_or(Window::Hann);
        shutter.speed_change(&tiles, map.plan.tile_px(), window, exposure).map_err(|error| error.to_string())
    }

    /// The shutter, whose rows are those of the picture as stored.
    fn shutter(&self) -> Result<Option<RollingShutter>> {
        let rows = self.picture.stored_frame().stored_height_px();
        Ok(self.options.readout_s.map(|readout_s| RollingShutter::new(readout_s, rows)).transpose()?)
    }

    /// A blur of the upright picture in the frame of the sensor.
    fn stored_blur(&self, blur: &MotionBlur) -> RolledBlur {
        let frame = self.picture.stored_frame();
        let correlation = blur.correlation.unwrap_or(0.0);
        RolledBlur {
            length_px: blur.length_px,
            length_std_px: blur.length_std_px,
            angle: AxialAngle::from_deg(frame.stored_deg(blur.angle.deg())),
            angle_std_deg: blur.angle_std_deg,
            // A mirrored axis turns the other way.
            correlation: if frame.is_mirrored() { -correlation } else { correlation },
        }
    }

    fn exposure_alone(&self) -> Option<Exposure> {
        self.exposure.map(|(exposure, _)| exposure)
    }
}
