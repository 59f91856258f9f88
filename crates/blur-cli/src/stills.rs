//! The sharp pictures of `--reference`.

use std::path::PathBuf;

use blur_core::estimate::{Settings, registry};
use blur_core::image::Region;

use crate::input::{self, Input};
use crate::method::Method;
use crate::picture::{self, Linearize};
use crate::{Error, Result, sample};

/// The method called `name`, or the first one that compares with sharp pictures, with the stills that `arguments` stand
/// for: files, folders, patterns. They are read once; `roi` and `linearize` apply to them as to the pictures.
pub fn method(
    name: Option<&str>,
    arguments: &[PathBuf],
    roi: Option<Region>,
    linearize: Linearize,
    settings: &Settings,
) -> Result<Method> {
    let known = || registry::REFERENCE.iter().map(|method| method.name).collect::<Vec<_>>().join(", ");
    let method = match name {
        Some(name) => registry::REFERENCE
            .iter()
            .find(|method| method.name == name)
            .ok_or_else(|| Error::NoUseForStills { method: name.to_owned(), known: known() })?,
        None => registry::REFERENCE.first().ok_or(Error::NoMethod { kind: "reference" })?,
    };
    let (mut names, mut stills) = (Vec::new(), Vec::new());
    for input in input::expand(arguments) {
        let name = PathBuf::from(input.name());
        let read = match input {
            Input::File(path) => picture::read(&path, linearize).map_err(Error::from),
            Input::Sample => picture::decode(sample::PNG, linearize).map_err(Error::from),
            Input::Failed { error, .. } => Err(error),
        };
        match read {
            Ok(still) => stills.push(still.luma),
            Err(error) => return Err(error.in_file(&name)),
        }
        names.push(name);
    }
    let mut views = Vec::with_capacity(stills.len());
    for (name, still) in names.into_iter().zip(&stills) {
        let view = roi.map_or(Ok(still.view()), |region| region.of(still.view()));
        views.push(view.map_err(|error| Error::from(error).in_file(&name))?);
    }
    let mut estimator = method.build(&views, settings)?;
    if let (Some(region), Some(still)) = (roi, stills.first()) {
        // The lens has its centre in the middle of the whole picture.
        let (rows, columns) = still.dim();
        let middle = |size: usize, first: usize| 0.5 * (size as f64 - 1.0) - first as f64;
        estimator = estimator.with_optical_centre(middle(columns, region.x), middle(rows, region.y));
    }
    Ok(Method::with_stills(method.name, estimator))
}
