//! Maximum likelihood over camera and poses together (Zhang 2000, eq. 14): Levenberg-Marquardt.
//!
//! The normal matrix has the shape of an arrow: every view shares the camera and has six parameters of its own. The views
//! are eliminated one by one (Schur complement), which is linear in their number.

use nalgebra::{DMatrix, DVector, Matrix2x3, Matrix6, SMatrix, Vector2, Vector6};

use super::pose::Pose;
use super::{Model, View, too_alike};
use crate::Result;
use crate::camera::intrinsics::{Covariance, PARAMETERS, pixel};

const MAX_STEPS: usize = 500;
/// The damping with which the search starts, and beyond which no step helps.
const DAMPING: (f64, f64) = (1e-3, 1e12);
/// A step that is expected to lower the sum of squares by less than this part of it is the last.
const CONVERGED: f64 = 1e-15;

pub(super) struct Refined {
    pub(super) parameters: [f64; PARAMETERS],
    pub(super) covariance: Covariance,
    pub(super) poses: Vec<Pose>,
    /// Sum of squared distances in pixels, for each view.
    pub(super) view_squares: Vec<f64>,
}

/// One view's part of the normal equations.
struct Block {
    camera: Covariance,
    camera_gradient: SMatrix<f64, PARAMETERS, 1>,
    mixed: SMatrix<f64, PARAMETERS, 6>,
    pose: Matrix6<f64>,
    pose_gradient: Vector6<f64>,
    squares: f64,
}

struct Step {
    camera: [f64; PARAMETERS],
    poses: Vec<Vector6<f64>>,
    /// By how much the sum of squares falls if the model is linear.
    expected: f64,
}

pub(super) fn refine(
    views: &[View],
    start: [f64; PARAMETERS],
    start_poses: Vec<Pose>,
    model: Model,
) -> Result<Refined> {
    let fitted: Vec<usize> = model.fitted().iter().enumerate().filter_map(|(i, &fit)| fit.then_some(i)).collect();
    let (mut parameters, mut poses) = (start, start_poses);
    let mut blocks = linearised(views, &parameters, &poses).ok_or_else(|| too_alike(start[0], f64::INFINITY))?;
    let mut damping = DAMPING.0;
    for _ in 0..MAX_STEPS {
        let squares = total(&blocks);
        let step = solve(&blocks, &fitted, damping);
        let tried = step.as_ref().and_then(|step| {
            let parameters: [f64; PARAMETERS] = std::array::from_fn(|i| parameters[i] + step.camera[i]);
            let poses: Vec<Pose> = poses.iter().zip(&step.poses).map(|(pose, by)| moved(pose, by)).collect();
            let blocks = linearised(views, &parameters, &poses)?;
            Some((parameters, poses, blocks))
        });
        match (tried, step) {
            (Some(next), Some(step)) if total(&next.2) <= squares => {
                (parameters, poses, blocks) = next;
                damping *= 0.1;
                if step.expected <= CONVERGED * squares {
                    break;
                }
            }
            // At the bottom rounding decides whether the sum still falls.
            (Some(_), Some(step)) if step.expected <= CONVERGED * squares => break,
            _ => damping *= 10.0,
        }
        if damping > DAMPING.1 {
            break;
        }
    }
    let covariance = covariance(views, &blocks, &fitted).ok_or_else(|| too_alike(parameters[0], f64::INFINITY))?;
    let view_squares = blocks.iter().map(|block| block.squares).collect();
    Ok(Refined { parameters, covariance, poses, view_squares })
}

fn total(blocks: &[Block]) -> f64 {
    blocks.iter().map(|block| block.squares).sum()
}

fn moved(pose: &Pose, by: &Vector6<f64>) -> Pose {
    pose.moved(by.fixed_rows::<3>(0).into(), by.fixed_rows::<3>(3).into())
}

/// The normal equations of every view; `None` when a point is not in front of the camera.
fn linearised(views: &[View], parameters: &[f64; PARAMETERS], poses: &[Pose]) -> Option<Vec<Block>> {
    views.iter().zip(poses).map(|(view, pose)| block(view, parameters, pose)).collect()
}

fn block(view: &View, parameters: &[f64; PARAMETERS], pose: &Pose) -> Option<Block> {
    let mut block = Block {
        camera: SMatrix::zeros(),
        camera_gradient: SMatrix::zeros(),
        mixed: SMatrix::zeros(),
        pose: SMatrix::zeros(),
        pose_gradient: SMatrix::zeros(),
        squares: 0.0,
    };
    for (&board, &image) in view.board.iter().zip(&view.image_px) {
        let (residual, by_camera, by_pose) = residual(parameters, pose, board, image)?;
        block.camera += by_camera.transpose() * by_camera;
        block.camera_gradient += by_camera.transpose() * residual;
        block.mixed += by_camera.transpose() * by_pose;
        block.pose += by_pose.transpose() * by_pose;
        block.pose_gradient += by_pose.transpose() * residual;
        block.squares += residual.norm_squared();
    }
    block.squares.is_finite().then_some(block)
}

type Residual = (Vector2<f64>, SMatrix<f64, 2, PARAMETERS>, SMatrix<f64, 2, 6>);

/// Seen minus expected, and how the expected pixel depends on the camera and on a turn and a shift of the board.
fn residual(parameters: &[f64; PARAMETERS], pose: &Pose, board: [f64; 2], image: [f64; 2]) -> Option<Residual> {
    let place = pose.place(board);
    let is_in_front = place.z > 0.0;
    if !is_in_front {
        return None;
    }
    let ideal = place.xy() / place.z;
    let seen = pixel(parameters, ideal);
    let by_place = seen.by_ideal * Matrix2x3::new(1.0, 0.0, -ideal.x, 0.0, 1.0, -ideal.y) / place.z;
    let mut by_pose = SMatrix::<f64, 2, 6>::zeros();
    // A small turn w moves the turned point r by w x r = -[r]x w.
    let arm = place - pose.translation;
    by_pose.fixed_view_mut::<2, 3>(0, 0).copy_from(&(-by_place * arm.cross_matrix()));
    by_pose.fixed_view_mut::<2, 3>(0, 3).copy_from(&by_place);
    Some((Vector2::from(image) - seen.point, seen.by_parameters, by_pose))
}

/// The damped step; `None` when the equations are singular.
fn solve(blocks: &[Block], fitted: &[usize], damping: f64) -> Option<Step> {
    let size = fitted.len();
    let mut matrix = DMatrix::zeros(size, size);
    let mut gradient = DVector::zeros(size);
    let mut eliminated = Vec::with_capacity(blocks.len());
    for block in blocks {
        let mut pose = block.pose;
        for i in 0..6 {
            pose[(i, i)] *= 1.0 + damping;
        }
        let factor = pose.cholesky()?;
        let weights = factor.solve(&block.mixed.transpose());
        let own = factor.solve(&block.pose_gradient);
        let shared = block.camera - block.mixed * weights;
        let shared_gradient = block.camera_gradient - block.mixed * own;
        for (row, &i) in fitted.iter().enumerate() {
            gradient[row] += shared_gradient[i];
            for (column, &j) in fitted.iter().enumerate() {
                matrix[(row, column)] += shared[(i, j)];
            }
            matrix[(row, row)] += damping * block.camera[(i, i)];
        }
        eliminated.push((weights, own));
    }
    let solution = matrix.cholesky()?.solve(&gradient);
    let mut camera = SMatrix::<f64, PARAMETERS, 1>::zeros();
    for (&i, &value) in fitted.iter().zip(solution.iter()) {
        camera[i] = value;
    }
    let poses: Vec<Vector6<f64>> = eliminated.iter().map(|(weights, own)| own - weights * camera).collect();
    let expected = blocks
        .iter()
        .zip(&poses)
        .map(|(block, pose)| camera.dot(&block.camera_gradient) + pose.dot(&block.pose_gradient))
        .sum();
    Some(Step { camera: camera.into(), poses, expected })
}

/// Covariance of the camera with the poses free: the inverse of the Schur complement times the variance of a coordinate.
fn covariance(views: &[View], blocks: &[Block], fitted: &[usize]) -> Option<Covariance> {
    let mut matrix = DMatrix::<f64>::zeros(fitted.len(), fitted.len());
    for block in blocks {
        let shared = block.camera - block.mixed * block.pose.cholesky()?.solve(&block.mixed.transpose());
        for (row, &i) in fitted.iter().enumerate() {
            for (column, &j) in fitted.iter().enumerate() {
                matrix[(row, column)] += shared[(i, j)];
            }
        }
    }
    // Scaled to a diagonal of ones, so that pixels and pure numbers weigh the same.
    let scale = DVector::from_iterator(fitted.len(), matrix.diagonal().iter().map(|d| 1.0 / d.sqrt()));
    let scaled = DMatrix::from_diagonal(&scale) * &matrix * DMatrix::from_diagonal(&scale);
    let inverse = scaled.cholesky()?.inverse();
    let observations: usize = 2 * views.iter().map(|view| view.board.len()).sum::<usize>();
    let free = observations.checked_sub(fitted.len() + 6 * views.len()).filter(|&free| free > 0)?;
    let variance = total(blocks) / free as f64;
    let mut covariance = Covariance::zeros();
    for (row, &i) in fitted.iter().enumerate() {
        for (column, &j) in fitted.iter().enumerate() {
            let symmetric = 0.5 * (inverse[(row, column)] + inverse[(column, row)]);
            covariance[(i, j)] = variance * scale[row] * scale[column] * symmetric;
        }
    }
    Some(covariance)
}
