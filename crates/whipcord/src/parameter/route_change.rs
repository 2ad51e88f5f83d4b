//! How a cable's course changes with the parameters of its routing.

use core::f64::consts::TAU;

use whipcord_numerics::{PiecewiseCubic, Vec3};

use super::quantity::Parameter;
use crate::robot::fourier::Fourier;
use crate::robot::route::{Curve, HolePlaces, Route, hole_places, plane, polynomial};
use crate::robot::{Interpolation, Robot, Routing};

/// Derivative of a [`Route`] by a parameter.
#[derive(Clone, Debug)]
pub(crate) struct RouteChange {
    curve: Change,
}

#[derive(Clone, Debug)]
enum Change {
    /// Of angle and radius along a polar course.
    Polar {
        angle: Along,
        radius: Along,
    },
    Fourier {
        x: Fourier,
        y: Fourier,
    },
    Polynomial {
        x: Vec<f64>,
        y: Vec<f64>,
    },
}

/// A function of arc length.
#[derive(Clone, Debug)]
enum Along {
    Constant(f64),
    Linear(f64),
    Cubic(PiecewiseCubic),
}

impl Along {
    fn at(&self, s: f64) -> [f64; 2] {
        match self {
            Self::Constant(value) => [*value, 0.0],
            Self::Linear(slope) => [slope * s, *slope],
            Self::Cubic(cubic) => {
                let [value, slope, _] = cubic.evaluate(s);
                [value, slope]
            }
        }
    }
}

impl RouteChange {
    /// Of the course of one cable of a robot; `None` where the parameter does not move it.
    pub(crate) fn new(robot: &Robot, cable: usize, parameter: &Parameter) -> Option<Self> {
        let length = robot.backbone().length;
        let curve = match (&robot.cables()[cable].routing, *parameter) {
            (Routing::Holes { holes, interpolation }, parameter) => {
                return Self::of_holes(robot, cable, holes, *interpolation, parameter);
            }
            (Routing::Straight { angle, radius }, Parameter::Angle { cable: c }) if c == cable => {
                Change::Polynomial { x: vec![-radius * angle.sin()], y: vec![radius * angle.cos()] }
            }
            (Routing::Straight { angle, .. }, Parameter::Radius { cable: c }) if c == cable => {
                Change::Polynomial { x: vec![angle.cos()], y: vec![angle.sin()] }
            }
            (Routing::Helix { .. }, parameter) => {
                let (angle, radius) = match parameter {
                    Parameter::Angle { cable: c } if c == cable => {
                        (Along::Constant(1.0), Along::Constant(0.0))
                    }
                    Parameter::Radius { cable: c } if c == cable => {
                        (Along::Constant(0.0), Along::Constant(1.0))
                    }
                    Parameter::Turns { cable: c } if c == cable => {
                        (Along::Linear(TAU / length), Along::Constant(0.0))
                    }
                    _ => return None,
                };
                Change::Polar { angle, radius }
            }
            (Routing::Linear { .. }, Parameter::Start { cable: c, axis }) if c == cable => {
                along_axis(axis, vec![1.0, -1.0 / length])
            }
            (Routing::Linear { .. }, Parameter::End { cable: c, axis }) if c == cable => {
                along_axis(axis, vec![0.0, 1.0 / length])
            }
            (Routing::Polynomial { .. }, Parameter::Coefficient { cable: c, axis, power })
                if c == cable =>
            {
                let mut coefficients = vec![0.0; power + 1];
                coefficients[power] = 1.0;
                along_axis(axis, coefficients)
            }
            _ => return None,
        };
        Some(Self { curve })
    }

    fn of_holes(
        robot: &Robot,
        cable: usize,
        holes: &[usize],
        interpolation: Interpolation,
        parameter: Parameter,
    ) -> Option<Self> {
        let disks = robot.disks();
        let n = holes.len();
        let unit = |at: usize| (0..n).map(|i| if i == at { 1.0 } else { 0.0 }).collect();
        let (d_angles, d_radii): (Vec<f64>, Vec<f64>) = match parameter {
            Parameter::HoleRadius => (vec![0.0; n], vec![1.0; n]),
            Parameter::HoleRadiusAt { disk } if disk < n => (vec![0.0; n], unit(disk)),
            Parameter::HoleAngle { cable: c, disk } if c == cable && disk < n => {
                (unit(disk), vec![0.0; n])
            }
            Parameter::Angle { cable: c } if c == cable => (vec![1.0; n], vec![0.0; n]),
            Parameter::Radius { cable: c } if c == cable => (vec![0.0; n], vec![1.0; n]),
            _ => return None,
        };
        let knots = &disks.arc_lengths[..n];
        let HolePlaces { angles, radii } = hole_places(&robot.cables()[cable], holes, disks);
        let curve = match interpolation {
            Interpolation::Fourier => {
                let along = |f: &dyn Fn(usize) -> f64| -> Vec<f64> { (0..n).map(f).collect() };
                let x = along(&|i| {
                    d_radii[i] * angles[i].cos() - radii[i] * d_angles[i] * angles[i].sin()
                });
                let y = along(&|i| {
                    d_radii[i] * angles[i].sin() + radii[i] * d_angles[i] * angles[i].cos()
                });
                // The series is linear in its values.
                Change::Fourier { x: Fourier::through(knots, &x), y: Fourier::through(knots, &y) }
            }
            Interpolation::Spline => Change::Polar {
                angle: Along::Cubic(PiecewiseCubic::spline(knots, &d_angles).ok()?),
                radius: Along::Cubic(PiecewiseCubic::spline(knots, &d_radii).ok()?),
            },
            Interpolation::Pchip => Change::Polar {
                angle: Along::Cubic(PiecewiseCubic::pchip_change(knots, &angles, &d_angles).ok()?),
                radius: Along::Cubic(PiecewiseCubic::pchip_change(knots, &radii, &d_radii).ok()?),
            },
        };
        Some(Self { curve })
    }

    /// Change of offset `r` and slope `r′` at an arc length, on the route that changes.
    pub(crate) fn at(&self, route: &Route, s: f64) -> (Vec3, Vec3) {
        match &self.curve {
            Change::Polynomial { x, y } => {
                let point = plane(polynomial(x, s), polynomial(y, s));
                (point.offset, point.slope)
            }
            Change::Fourier { x, y } => {
                let point = plane(x.evaluate(s), y.evaluate(s));
                (point.offset, point.slope)
            }
            Change::Polar { angle, radius } => {
                let ([a, a_rate], [r, r_rate]) = match &route.curve {
                    Curve::Polar { angle, radius } => {
                        let ([a, da, _], [r, dr, _]) = (angle.evaluate(s), radius.evaluate(s));
                        ([a, da], [r, dr])
                    }
                    Curve::Helix { start_angle, rate, radius } => {
                        ([start_angle + rate * s, *rate], [*radius, 0.0])
                    }
                    // No other course is polar.
                    Curve::Fourier { .. } | Curve::Polynomial { .. } => return Default::default(),
                };
                let ([da, da_rate], [dr, dr_rate]) = (angle.at(s), radius.at(s));
                let (sin, cos) = a.sin_cos();
                let radial = Vec3::new(cos, sin, 0.0);
                let around = Vec3::new(-sin, cos, 0.0);
                let offset = dr * radial + r * da * around;
                let slope = (dr_rate - r * a_rate * da) * radial
                    + (r_rate * da + dr * a_rate + r * da_rate) * around;
                (offset, slope)
            }
        }
    }
}

fn along_axis(axis: usize, coefficients: Vec<f64>) -> Change {
    match axis {
        0 => Change::Polynomial { x: coefficients, y: Vec::new() },
        _ => Change::Polynomial { x: Vec::new(), y: coefficients },
    }
}
