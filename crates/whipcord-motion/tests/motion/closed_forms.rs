//! A pendulum, the Princeton beam, a helix and heavy beams, each against closed forms or an integration of the classical equations in this file.

use core::f64::consts::PI;

use whipcord::robot::BackboneSegment;
use whipcord::{Backbone, Case, Disks, Loads, Robot, Stiffness, Vec3};
use whipcord_motion::{Commands, Damping, Initial, Method, MotionOptions, Simulation};
use whipcord_numerics::{DenseLu, Pose, Twist, UnitQuaternion, integral};

use super::robots::rod;

/// A stiff rod of one element on a short flexible segment, let go at an angle to its weight: a physical pendulum with a weak torsion spring, whose
/// period is an elliptic integral but for that spring.
struct Pendulum {
    /// From the middle of the hinge to the tip in m.
    length: f64,
    /// Mass per length in kg/m.
    density: f64,
    /// Stiffness of the hinge in N·m.
    spring: f64,
    /// Squared radius of gyration of its sections in m².
    gyration: f64,
    /// Angle to the weight at which it is let go, where the spring is at rest.
    start: f64,
}

const GRAVITY: f64 = 9.81;

impl Pendulum {
    fn potential(&self, angle: f64) -> f64 {
        let weight = self.density * self.length * GRAVITY * 0.5 * self.length;
        weight * (1.0 - angle.cos()) + 0.5 * self.spring * (angle - self.start).powi(2)
    }

    /// Time in s until it is back: `2 ∫ dφ / φ̇` between the angles at which it rests.
    fn period(&self) -> f64 {
        let inertia = self.density * self.length * (self.length.powi(2) / 3.0 + self.gyration);
        // The other angle of rest, by bisection.
        let lost = |angle: f64| self.potential(angle) - self.potential(self.start);
        let (mut low, mut high) = (-PI, 0.0);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if lost(middle) > 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        let other = 0.5 * (low + high);
        // With φ = mean + half sin x the integrand has no pole at its ends.
        let (mean, half) = (0.5 * (self.start + other), 0.5 * (self.start - other));
        let integrand = |x: f64| {
            let angle = mean + half * x.sin();
            half * x.cos() / (-2.0 / inertia * lost(angle)).sqrt()
        };
        2.0 * integral(&integrand, [-0.5 * PI, 0.5 * PI], 1e-10)
    }
}

/// Without the spring the period is `4 √(2L/3g) K(sin φ₀/2)`: the quadrature of the reference itself.
#[test]
fn the_period_of_the_reference_is_the_elliptic_integral() {
    let pendulum = Pendulum { length: 0.5, density: 2.0, spring: 0.0, gyration: 0.0, start: 1.2 };
    // K(k) by the arithmetic-geometric mean.
    let (mut a, mut b) = (1.0, (0.5_f64 * pendulum.start).cos());
    for _ in 0..6 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    let exact = 4.0 * (2.0 * pendulum.length / (3.0 * GRAVITY)).sqrt() * PI / (2.0 * a);
    assert!((pendulum.period() / exact - 1.0).abs() < 1e-9);
}

#[test]
fn a_pendulum_of_one_stiff_element_has_its_exact_period() {
    let (length, hinge, density) = (0.5, 5e-5, 2.0);
    let (axial, bending, soft) = (1e8, 1e4, 1e-9);
    for start in [0.6_f64, 1.2, 2.0] {
        let backbone = Backbone {
            stiffness: Some(Stiffness::diagonal([axial; 2], axial, [bending; 2], bending)),
            segments: vec![BackboneSegment {
                bending_factor: soft,
                ..BackboneSegment::new("hinge", [0.0, hinge])
            }],
            linear_density: Some(density.into()),
            ..Backbone::new(length)
        };
        let robot = Robot::new(backbone, Disks::none(length), vec![]).unwrap();
        let down = Vec3::new(start.sin(), 0.0, start.cos()) * GRAVITY;
        let loads = Loads { gravity: Some(down), ..Loads::default() };
        let pendulum = Pendulum {
            length: length - 0.5 * hinge,
            density,
            spring: bending * soft / hinge,
            // Of a section without area: EI/EA.
            gyration: bending / axial,
            start,
        };
        let exact = pendulum.period();
        for (method, limit) in [(Method::Accurate, 3e-5), (Method::Robust, 5e-5)] {
            let options = MotionOptions {
                initial: Initial::Rest,
                method,
                elements: 1,
                ..MotionOptions::default()
            };
            let case = Case { loads: loads.clone(), ..Case::default() };
            let mut simulation = Simulation::new(&robot, &case, options).unwrap();
            assert_eq!(
                simulation.arc_lengths().len(),
                5,
                "one element for the hinge, one for the rod"
            );
            // Where the tip comes to rest for the second time, it has made a period.
            let dt = exact / if method == Method::Robust { 4000.0 } else { 400.0 };
            let (mut rests, mut before, mut period) = (0, 0.0, f64::NAN);
            for k in 0..100_000 {
                let state = simulation.step(&Commands::default(), dt).unwrap();
                let rate = state.velocities[4].angular.y;
                if k > 0 && (rate < 0.0) != (before < 0.0) {
                    rests += 1;
                    if rests == 2 {
                        period = state.time - dt * rate / (rate - before);
                        break;
                    }
                }
                before = rate;
            }
            assert!((period / exact - 1.0).abs() < limit, "{start} {method:?}: {period} {exact}");
        }
    }
}

/// The classical equations of a rod under a dead force at its tip, `p′ = R v`, `R′ = R û`, `M′ = −v × F`: by the Runge–Kutta method of order 4 in many steps
/// from a moment at the base, which Newton's method finds with differences.
fn tip_of_a_loaded_rod(
    length: f64,
    (shear, axial, bending, torsion): ([f64; 2], f64, [f64; 2], f64),
    force: Vec3,
) -> Pose {
    type Rate = (Vec3, [f64; 4], Vec3);
    const STEPS: usize = 400;
    let rate = |rotation: [f64; 4], moment: Vec3| -> Rate {
        let q = UnitQuaternion::from_wxyz(rotation).unwrap();
        let n = q.conjugate().rotate(force);
        let v = Vec3::new(n.x / shear[0], n.y / shear[1], 1.0 + n.z / axial);
        let u = Vec3::new(moment.x / bending[0], moment.y / bending[1], moment.z / torsion);
        // In the frame of the section: m′ = m × u + n × v.
        (q.rotate(v), q.rate(u), moment.cross(u) + n.cross(v))
    };
    let integrate = |moment: Vec3| {
        let h = length / STEPS as f64;
        let (mut p, mut q, mut m) = (Vec3::ZERO, [1.0, 0.0, 0.0, 0.0], moment);
        for _ in 0..STEPS {
            let ahead = |r: &Rate, f: f64| {
                (core::array::from_fn::<f64, 4, _>(|i| q[i] + r.1[i] * f), m + r.2 * f)
            };
            let a = rate(q, m);
            let (q1, m1) = ahead(&a, 0.5 * h);
            let b = rate(q1, m1);
            let (q2, m2) = ahead(&b, 0.5 * h);
            let c = rate(q2, m2);
            let (q3, m3) = ahead(&c, h);
            let d = rate(q3, m3);
            p += (a.0 + (b.0 + c.0) * 2.0 + d.0) * (h / 6.0);
            m += (a.2 + (b.2 + c.2) * 2.0 + d.2) * (h / 6.0);
            for i in 0..4 {
                q[i] += h / 6.0 * (a.1[i] + 2.0 * (b.1[i] + c.1[i]) + d.1[i]);
            }
        }
        (Pose { position: p, rotation: UnitQuaternion::from_wxyz(q).unwrap() }, m)
    };
    let mut moment = Vec3::ZERO;
    let mut lu = DenseLu::default();
    for _ in 0..30 {
        let (tip, left) = integrate(moment);
        if left.norm() < 1e-12 {
            return tip;
        }
        let mut matrix = vec![0.0; 9];
        let d = 1e-6;
        for (j, axis) in [Vec3::X, Vec3::Y, Vec3::Z].into_iter().enumerate() {
            let by = (integrate(moment + axis * d).1 - integrate(moment - axis * d).1) * (0.5 / d);
            for (i, value) in by.to_array().into_iter().enumerate() {
                matrix[3 * i + j] = value;
            }
        }
        let mut change = left.to_array();
        lu.factor(3, &matrix).unwrap();
        lu.solve(&mut change);
        moment -= Vec3::new(change[0], change[1], change[2]);
    }
    panic!("the reference does not converge");
}

/// The beam of the Princeton experiments (Dowell and Traybar 1975: aluminium, 0.508 m, 12.77 mm by 3.2024 mm), whose clamp turns it against a weight at its tip:
/// bending about both axes twists it. The motion starts in that equilibrium, and one that is let go from rest ends in it.
#[test]
fn the_princeton_beam_bends_twists_and_comes_to_rest() {
    let (length, height, thickness) = (0.508_f64, 12.77e-3_f64, 3.2024e-3_f64);
    let (young, poisson) = (71.7e9, 0.31);
    let shear_modulus = young / (2.0 * (1.0 + poisson));
    let area = height * thickness;
    // Bending about x is that across the thickness.
    let bending =
        [young * height * thickness.powi(3) / 12.0, young * thickness * height.powi(3) / 12.0];
    let torsion =
        shear_modulus * height * thickness.powi(3) / 3.0 * (1.0 - 0.63 * thickness / height);
    let shear = [shear_modulus * area / 1.2; 2];
    let axial = young * area;
    let backbone = Backbone {
        stiffness: Some(Stiffness::diagonal(shear, axial, bending, torsion)),
        linear_density: Some((2800.0 * area).into()),
        ..Backbone::new(length)
    };
    let robot = Robot::new(backbone, Disks::none(length), vec![]).unwrap();
    for weight in [4.448, 8.896, 13.345] {
        for degrees in [0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0_f64] {
            let angle = degrees.to_radians();
            let force = Vec3::new(angle.cos(), angle.sin(), 0.0) * weight;
            let exact = tip_of_a_loaded_rod(length, (shear, axial, bending, torsion), force);
            let loads = Loads { tip_force: force, ..Loads::default() };
            let case = Case { loads, ..Case::default() };
            let tip = |initial: Initial, steps: usize| {
                let options = MotionOptions {
                    initial,
                    elements: 10,
                    damping: Damping::Time(0.02),
                    ..MotionOptions::default()
                };
                let mut simulation = Simulation::new(&robot, &case, options).unwrap();
                for _ in 0..steps {
                    simulation.step(&Commands::default(), 0.01).unwrap();
                }
                simulation.state().tip()
            };
            let mut ends = vec![(tip(Initial::Equilibrium, 0), 1e-6)];
            if degrees % 45.0 == 0.0 {
                ends.push((tip(Initial::Rest, 400), 2e-6));
            }
            for (got, limit) in ends {
                let apart = (got.position - exact.position).norm() / length;
                let turned = (got.rotation.conjugate() * exact.rotation).log().norm();
                assert!(
                    apart < limit && turned < 1e-5,
                    "{weight} N, {degrees}°: {apart:e} {turned:e}"
                );
            }
            // The twist is what linear theory has none of.
            let twisted = (exact.rotation.log().z).abs();
            assert_eq!(twisted > 1e-3, degrees > 1.0 && degrees < 89.0, "{degrees}° {twisted}");
        }
    }
}

/// A straight rod that a force and a couple at its tip hold as a helix (Kirchhoff; Love, *A treatise on the mathematical theory of elasticity*, article 270): curvature κ and
/// twist τ are the same everywhere, with the shear force λκ and tension λτ of `κτ(GJ − EI) = λκ(1 + λτ/EA − λτ/GA)`. With a force and a couple
/// that turn with the tip it stays at rest.
#[test]
fn a_rod_is_held_as_a_helix() {
    let (length, bending, torsion) = (0.4, 0.02, 0.015);
    let (shear, axial) = (4e2, 1e3);
    let backbone = Backbone {
        stiffness: Some(Stiffness::diagonal([shear; 2], axial, [bending; 2], torsion)),
        linear_density: Some(0.05.into()),
        ..Backbone::new(length)
    };
    let robot = Robot::new(backbone, Disks::none(length), vec![]).unwrap();
    for (curvature, twist) in [(5.0, 3.0), (8.0, -6.0), (12.0, 9.0)] {
        // λ of the quadratic equation, the root that is small.
        let (a, c): (f64, f64) = (twist * (1.0 / axial - 1.0 / shear), twist * (bending - torsion));
        let lambda = -2.0 * c / (1.0 + (1.0 - 4.0 * a * c).sqrt());
        let u = Vec3::new(0.0, curvature, twist);
        let n = u * lambda;
        let v = Vec3::new(0.0, n.y / shear, 1.0 + n.z / axial);
        let m = Vec3::new(0.0, bending * curvature, torsion * twist);
        let strain = Twist { linear: v, angular: u };
        let tip = Pose::exp(strain * length);
        for follower in [false, true] {
            let turn = if follower { UnitQuaternion::IDENTITY } else { tip.rotation };
            let loads = Loads {
                tip_force: turn.rotate(n),
                tip_moment: turn.rotate(m),
                tip_follower: follower,
                ..Loads::default()
            };
            let case = Case { loads, ..Case::default() };
            let options =
                MotionOptions { damping: Damping::Time(1e-3), ..MotionOptions::default() };
            let mut simulation = Simulation::new(&robot, &case, options).unwrap();
            for k in 0..=50 {
                let state = simulation.state();
                let apart = (state.tip().position - tip.position).norm();
                assert!(apart < 1e-10 * length, "{curvature} {twist} {follower} {k}: {apart:e}");
                for of in &state.strains {
                    let change = *of - strain;
                    assert!(change.linear.norm() + length * change.angular.norm() < 1e-9);
                }
                assert!(state.energy.kinetic < 1e-18, "{:e}", state.energy.kinetic);
                // A couple that does not turn with the tip has no potential: it can drive the rod away from its helix.
                if !follower {
                    break;
                }
                simulation.step(&Commands::default(), 0.01).unwrap();
            }
        }
    }
}

/// Squared frequency, in units of EI/ρAL⁴, of a cantilever under its weight `weight = ρAgL³/EI` along it, positive where it hangs: with x from the tip
/// `w⁗ − weight (x w′)′ = ω² w` as a power series.
fn squared_frequencies(weight: f64, count: usize) -> Vec<f64> {
    const TERMS: usize = 120;
    let determinant = |square: f64| {
        // w and w′ at the clamp of the series that begin with 1 and with x; moment and shear force at the tip are zero.
        let end = |first: usize| {
            let mut a = vec![0.0_f64; TERMS];
            a[first] = 1.0;
            for k in 0..TERMS - 4 {
                let (k0, k1) = (k as f64, k as f64 + 1.0);
                let down = (k0 + 4.0) * (k0 + 3.0) * (k0 + 2.0) * k1;
                a[k + 4] = (square * a[k] + weight * k1 * k1 * a[k + 1]) / down;
            }
            let slope: f64 = a.iter().enumerate().map(|(k, a)| k as f64 * a).sum();
            (a.iter().sum::<f64>(), slope)
        };
        let ((w0, s0), (w1, s1)) = (end(0), end(1));
        w0 * s1 - w1 * s0
    };
    let mut roots = Vec::new();
    let (mut low, mut of_low) = (-20.0, determinant(-20.0));
    // The fourth powers of βL grow so fast that steps of 1 % of the value pass none over.
    while roots.len() < count {
        let high = low + 0.5_f64.max(0.01 * low);
        let of_high = determinant(high);
        if (of_low < 0.0) != (of_high < 0.0) {
            let (mut a, mut b) = (low, high);
            for _ in 0..100 {
                let middle = 0.5 * (a + b);
                if (determinant(middle) < 0.0) == (of_low < 0.0) {
                    a = middle;
                } else {
                    b = middle;
                }
            }
            roots.push(0.5 * (a + b));
        }
        (low, of_low) = (high, of_high);
    }
    roots
}

/// Without weight the series has the roots of the cantilever, and a standing beam buckles at ρAgL³/EI = 7.837 (Greenhill).
#[test]
fn the_series_of_heavy_beams_has_known_limits() {
    let roots = squared_frequencies(0.0, 3);
    for (root, beta) in roots.iter().zip([1.875_104_07_f64, 4.694_091_13, 7.854_757_44]) {
        assert!((root / beta.powi(4) - 1.0).abs() < 1e-8);
    }
    assert!(squared_frequencies(-7.8373, 1)[0] > 0.0 && squared_frequencies(-7.8374, 1)[0] < 0.0);
}

/// Hanging and standing beams under their weight, up to one that nearly buckles.
#[test]
fn frequencies_of_heavy_beams() {
    let (length, radius, density) = (0.8_f64, 1e-3_f64, 1200.0);
    let area = PI * radius * radius;
    for weight in [-7.7, -6.0, -2.0, 3.0, 30.0, 200.0] {
        // The stiffness that gives this weight.
        let bending = density * area * GRAVITY * length.powi(3) / f64::abs(weight);
        let young = bending / (PI * radius.powi(4) / 4.0);
        let robot = rod(length, 2.0 * radius, young, 0.3, density, vec![]);
        let gravity = Vec3::new(0.0, 0.0, GRAVITY * f64::signum(weight));
        let case =
            Case { loads: Loads { gravity: Some(gravity), ..Loads::default() }, ..Case::default() };
        let options = MotionOptions { elements: 20, ..MotionOptions::default() };
        let mut simulation = Simulation::new(&robot, &case, options).unwrap();
        let modes = simulation.modes(&Commands::default(), 6).unwrap();
        let unit = bending / (density * area * length.powi(4));
        for (k, exact) in squared_frequencies(weight, 3).into_iter().enumerate() {
            // Each stands for both planes. Next to buckling the difference of two large numbers is left.
            for mode in &modes[2 * k..2 * k + 2] {
                let got = mode.squared_frequency / unit;
                let scale = exact.abs().max(12.36);
                assert!((got - exact).abs() < 2e-4 * scale, "{weight} {k}: {got} {exact}");
            }
        }
    }
}
