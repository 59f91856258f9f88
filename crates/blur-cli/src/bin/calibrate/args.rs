//! The command line of `calibrate`.

use std::path::PathBuf;

use blur_cli::{Result, units};
use blur_core::camera::{Board, Lens, Model, Pattern};
use clap::{Parser, ValueEnum};

const GUIDE: &str = "\
The board:
  checkerboard  squares of two colours in turn; --board counts the inner corners,
                where four squares meet: 9x6 for a board of 10 by 7 squares
  squares       separate dark squares on white (Zhang); --board counts the
                squares, --pitch is from one to the same place on the next
  Print it flat and to scale. Take 10 to 20 pictures with one focus and zoom, the
  board in all parts of the picture, tilted by 20 to 45 degrees in several
  directions. All of the board must be seen. Its size on paper does not change
  the camera found, only the proportion of square and pitch does.

Corners:
  Each is refined in a window that ends before the next edge of the board. With
  --corner-window PX all have the same, as with OpenCV, whose examples take 11:
  only to compare with results published so. Where the board is small or tilted
  it reaches other corners and draws them away, and the camera with them.

The camera:
  fx fy         focal lengths in pixels
  cx cy         where the optical axis meets the picture, from the centre of the
                top left pixel, x to the right and y down
  skew          with --skew, the obliquity of the sensor's axes, in pixels
  k1 k2 p1 p2 k3  distortion of the lens (Brown and Conrady, OpenCV's order)
  Pixels are those of the file, whichever way up EXIF data show the picture.
  After ± stands one standard uncertainty, from the scatter of the points. It does
  not know of a board that is bent or of wrong proportions.

Points instead of pictures:
  MODEL.txt holds X Y of all points of the board, each DATA.txt their u v in one
  picture, in the same order: two numbers for a point, any number of points on
  a line. --size is the size of the pictures.

Exit status:
  0  the camera is calibrated from all inputs
  1  some inputs were left out, or no camera was found
  2  the command line is wrong

Examples:
  calibrate left*.jpg --board 9x6 --square 25mm -o camera.json
  calibrate Calib*.png --pattern squares --board 8x8 --square 0.5in \\
            --pitch 0.888889in --distortion 2 --skew -o camera.json
  calibrate --points Model.txt data*.txt --size 640x480 -o camera.json
  estimate --camera camera.json --distance 1.21m --exposure 10ms run.png";

/// Calibrates a camera from pictures of a board, so that `estimate --camera` can tell speeds and undo the lens.
#[derive(Parser)]
#[command(
    name = "calibrate",
    version,
    after_help = "Boards, parameters, exit statuses and examples: calibrate --help",
    after_long_help = GUIDE,
    max_term_width = 110
)]
pub(crate) struct Args {
    /// Pictures of the board (PNG, JPEG, TIFF), folders of pictures, or patterns such as 'left*.jpg'; with --points,
    /// text files
    #[arg(value_name = "IMAGE|DIR|GLOB", required = true)]
    pub(crate) inputs: Vec<PathBuf>,

    /// Inner corners of the checkerboard, or squares, along and across: for instance 9x6
    #[arg(long, value_name = "COLUMNSxROWS", value_parser = units::columns_and_rows, required_unless_present = "points")]
    board: Option<(usize, usize)>,

    /// What is on the board
    #[arg(long, value_name = "NAME", default_value = "checkerboard")]
    pattern: PatternName,

    /// Side of a square, for instance 25mm
    #[arg(long, value_name = "LENGTH", value_parser = units::side_metres, default_value = "25mm")]
    square: f64,

    /// From one square to the same place on the next, for instance 40mm
    #[arg(long, value_name = "LENGTH", value_parser = units::side_metres, required_if_eq("pattern", "squares"))]
    pitch: Option<f64>,

    /// Refine the corners of a checkerboard in squares that reach so many pixels to each side, as other programs do [default:
    /// each as far as its own edges reach alone]
    #[arg(long, value_name = "PX", conflicts_with = "points")]
    corner_window: Option<usize>,

    /// Text file with the points of the board: the inputs are then text files with the points of each picture
    #[arg(long, value_name = "MODEL.txt", conflicts_with_all = ["board", "pattern", "square", "pitch"], requires = "size")]
    pub(crate) points: Option<PathBuf>,

    /// Size of the pictures that the points are from, for instance 640x480
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = units::columns_and_rows, requires = "points")]
    pub(crate) size: Option<(usize, usize)>,

    /// Also fit the skew of the sensor's axes (needs three views)
    #[arg(long)]
    skew: bool,

    /// Coefficients of distortion: k1 k2, k1 k2 p1 p2 or k1 k2 p1 p2 k3
    #[arg(long, value_name = "N", default_value = "5")]
    distortion: Coefficients,

    /// Write the camera to this file
    #[arg(short, long, value_name = "CAMERA.json")]
    pub(crate) output: Option<PathBuf>,

    /// Print the camera as JSON, as it stands in its file, instead of the table
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum PatternName {
    Checkerboard,
    Squares,
}

#[derive(Clone, Copy, ValueEnum)]
enum Coefficients {
    #[value(name = "2")]
    Two,
    #[value(name = "4")]
    Four,
    #[value(name = "5")]
    Five,
}

impl Args {
    /// The board, if there is one. What is refused here is a mistake on the command line.
    pub(crate) fn board(&self) -> Result<Option<Board>> {
        let Some((columns, rows)) = self.board else { return Ok(None) };
        let pattern = match self.pattern {
            PatternName::Checkerboard => Pattern::Checkerboard { square: self.square },
            PatternName::Squares => Pattern::Squares { square: self.square, pitch: self.pitch.unwrap_or(0.0) },
        };
        let board = Board::new(pattern, columns, rows)?;
        self.corner_window.map_or(Ok(board), |half_px| board.with_corner_window(half_px)).map(Some).map_err(Into::into)
    }

    pub(crate) fn model(&self) -> Model {
        let lens = match self.distortion {
            Coefficients::Two => Lens::Two,
            Coefficients::Four => Lens::Four,
            Coefficients::Five => Lens::Five,
        };
        Model { skew: self.skew, lens }
    }
}
