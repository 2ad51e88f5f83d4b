//! Pictures of cable-driven continuum robots, and of tables about them, as SVG and PNG.
//!
//! [`robot_figure`] draws a robot in space with three orthogonal views, [`overlay_figure`] over a
//! photograph; [`distance_chart`],
//! [`timing_chart`], [`accuracy_chart`] and [`pareto_chart`] draw tables, and [`Chart`] is what they are made with.
//! Each returns an SVG document, which [`png`] turns into pixels. Input is in SI units; pictures
//! show mm. The same input gives the same bytes on every machine.
//!
//! No mechanics and no files here.

mod accuracy;
mod acting;
mod axis;
mod body;
mod chart;
mod colour;
mod contact_marks;
mod disk_drawing;
mod distance;
mod drafting;
mod ellipsoid;
mod error;
mod film;
mod fit;
mod font;
mod histogram;
mod hull;
mod legend;
mod load_marks;
mod marker;
mod modes;
mod names;
mod obstacle_surface;
mod obstacles;
mod orthogonal;
mod outlines;
mod overlay;
mod pareto;
mod plates;
mod png;
mod projection;
mod robot_figure;
mod scene;
mod small_multiples;
mod space;
mod svg;
mod ticks;
mod time;
mod timing;
mod title;
mod unit;
mod workspace_figure;
mod workspace_model;

pub use accuracy::{AccuracySeries, accuracy_chart};
pub use acting::Acting;
pub use axis::Scale;
pub use chart::{AxisSpec, Chart, Layer, Series};
pub use colour::{CABLES, Colour, MODELS};
pub use disk_drawing::{DiskDrawingOptions, disk_drawing, disk_sheet};
pub use distance::{DistanceSeries, distance_chart};
pub use drafting::{DraftForm, DraftLayer, Drafting, Item as DraftItem};
pub use ellipsoid::{Ellipsoid, Quantity};
pub use error::PlotError;
pub use film::{FilmFrame, FilmPixels, film, film_pixels};
pub use histogram::histogram_chart;
pub use marker::Marker;
pub use modes::{ModeLine, ModesFigure, modes_figure};
pub use obstacle_surface::{ObstacleSurface, obstacle_surface};
pub use obstacles::OBSTACLE;
pub use outlines::outlined;
pub use overlay::{OverlayOptions, Photograph, overlay_figure};
pub use pareto::{ParetoSeries, pareto_chart};
pub use plates::{Plate, plates_of};
pub use png::png;
pub use robot_figure::{
    CableCourse, FINE_STATIONS, FigureOptions, RobotView, ViewStyle, label, robot_figure,
};
pub use small_multiples::{SmallMultiple, small_multiples};
pub use time::{OverTime, TimeSeries, time_chart};
pub use timing::{TimingSeries, timing_chart};
pub use workspace_figure::{WorkspaceFigure, workspace_figure};
pub use workspace_model::workspace_glb;
