//! What views of a board are wanted: the options of `lunula phantom board`, and a pipeline's keys.

use clap::Args;
use serde::Serialize;

use crate::camera::{BoardSize, square_mm};
use crate::job;
use crate::phantom::request::{parse_plane, parse_size};
use crate::phantom::scene::faults::Faults;
use crate::phantom::scene::lens::{MOST_TILT_DEG, Mapping, Oblique};

/// What `lunula phantom board` takes.
#[derive(Debug, Clone, PartialEq, Args, Serialize)]
pub struct BoardOptions {
    /// Seed of everything random
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// How many views
    #[arg(long, value_name = "N", default_value_t = 12)]
    pub views: usize,
    /// Inner corners of the board, across and down
    #[arg(long, value_name = "COLUMNSxROWS", default_value = "9x6")]
    pub board: BoardSize,
    /// Side of a square
    #[arg(long, value_name = "MM", default_value = "20", value_parser = square_mm)]
    pub square_mm: f64,
    /// Width and height of the views, pixels
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "1280x720", value_parser = parse_size)]
    pub size: (u32, u32),
    /// Focal length along rows [default: 1200 where the picture is 1280 wide]
    #[arg(long, value_name = "PX")]
    pub fx: Option<f64>,
    /// Focal length along columns [default: that along rows]
    #[arg(long, value_name = "PX")]
    pub fy: Option<f64>,
    /// Where the optical axis meets the picture [default: its middle]
    #[arg(long, value_name = "X,Y", value_parser = parse_pair, allow_hyphen_values = true)]
    pub centre: Option<[f64; 2]>,
    /// The lens' distortion, OpenCV's model
    #[arg(
        long, value_name = "k1,k2,p1,p2,k3", value_delimiter = ',', allow_hyphen_values = true,
        default_values_t = [-0.2, 0.05, 0.001, -0.0005, 0.0]
    )]
    pub distortion: Vec<f64>,
    /// The least and the most degrees between the board and the picture
    #[arg(long, value_name = "LEAST,MOST", default_value = "10,40", value_parser = parse_pair)]
    pub tilt: [f64; 2],
    /// Standard deviation of the sensor's noise, in 255ths of full scale
    #[arg(long, value_name = "SD", default_value_t = 2.0)]
    pub noise: f64,
    /// Standard deviation of the Gaussian that every edge is seen through
    #[arg(long, value_name = "PX", default_value_t = 0.7)]
    pub focus: f64,
    /// One view more, plane.png: the board in the plane in which `lunula phantom video --plane` moves its finger; so
    /// many degrees off straight, and the direction on the picture in which it recedes, clockwise from the right
    #[arg(long, value_name = "TILT[,TOWARDS]", value_parser = parse_plane, allow_hyphen_values = true)]
    pub plane: Option<Oblique>,
}

impl Default for BoardOptions {
    fn default() -> Self {
        job::defaults()
    }
}

/// Two numbers.
fn parse_pair(text: &str) -> Result<[f64; 2], String> {
    let pair = text.split_once(',').and_then(|(a, b)| Some([a.trim().parse().ok()?, b.trim().parse().ok()?]));
    pair.filter(|pair| pair.iter().all(|number: &f64| number.is_finite()))
        .ok_or_else(|| "write two numbers, as 10,40".to_owned())
}

impl BoardOptions {
    /// fx and fy, pixels.
    #[must_use]
    pub fn focal_px(&self) -> [f64; 2] {
        let fx = self.fx.unwrap_or(1200.0 / 1280.0 * f64::from(self.size.0));
        [fx, self.fy.unwrap_or(fx)]
    }

    /// cx and cy, pixels.
    #[must_use]
    pub fn centre_px(&self) -> [f64; 2] {
        let middle = |side: u32| 0.5 * (f64::from(side) - 1.0);
        self.centre.unwrap_or([middle(self.size.0), middle(self.size.1)])
    }

    pub(super) fn mapping(&self) -> Mapping {
        Mapping::of(self.focal_px(), self.centre_px(), &self.distortion)
    }

    /// Can it be drawn?
    pub fn check(&self) -> Result<(), Faults> {
        let (width, height) = self.size;
        let [least, most] = self.tilt;
        let mapping = self.mapping();
        let edge = |side: u32| [0.0, f64::from(side) - 1.0];
        let corners = edge(width).into_iter().flat_map(|x| edge(height).map(|y| [x, y]));
        let whole = corners.into_iter().all(|corner| mapping.ray(corner).is_some());
        let mut faults = Faults::default();
        faults.need((1..=200).contains(&self.views), || format!("--views {}: choose 1 to 200", self.views));
        faults.need((64..=8192).contains(&width) && (64..=8192).contains(&height), || {
            format!("--size {width}x{height}: sides from 64 to 8192 pixels can be drawn")
        });
        faults.need(self.focal_px().iter().all(|focal| focal.is_finite() && *focal > 0.0), || {
            "--fx, --fy: choose more than 0 px".to_owned()
        });
        faults.need(self.distortion.len() <= 5 && self.distortion.iter().all(|k| k.is_finite()), || {
            "--distortion: up to five numbers k1,k2,p1,p2,k3".to_owned()
        });
        faults.need(whole, || {
            format!("--distortion {:?}: so strong that the picture folds over; choose less", self.distortion)
        });
        faults.need(0.0 <= least && least <= most && most <= MOST_TILT_DEG, || {
            format!("--tilt {least},{most}: choose 0 to {MOST_TILT_DEG} degrees, the least first")
        });
        faults.range("--noise", self.noise, 0.0, 128.0, " of 255");
        faults.range("--focus", self.focus, 0.3, 20.0, " px");
        faults.need(self.plane.is_none_or(|plane| (0.0..=MOST_TILT_DEG).contains(&plane.tilt_deg)), || {
            format!("--plane: choose a tilt of 0 to {MOST_TILT_DEG} degrees")
        });
        faults.none()
    }
}
