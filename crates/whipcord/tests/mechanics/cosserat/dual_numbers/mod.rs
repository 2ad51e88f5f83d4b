//! The derivatives of the Cosserat model against dual numbers, which go through a rod of their own:
//! rotation matrices instead of quaternions, the classical Runge–Kutta method on many steps, sections
//! by Newton's method on all six equations. It shares no code with the model.

mod dual;
mod rod;

use core::f64::consts::PI;

use whipcord::cosserat::{Accuracy, Cosserat, Options, Workspace};
use whipcord::derivatives::{Hold, Place};
use whipcord::{
    Backbone, Cable, CableCommand, Case, Disks, DistributedLoad, Loads, Material, Parameter,
    PointLoad, Profile, RestCurvature, Robot, Routing, Section, Shortening, Vec3,
};

use dual::{Dual, c, cross, solve};
use rod::{LENGTH, PER_CABLE, RODS_OWN, Rod, SPREAD};

/// Numbers between −1 and 1, the same in every run.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// A random rod: its numbers by place, the robot, the case, and which parameter each number is.
fn random(
    seed: u64,
    loaded: bool,
    spread: bool,
) -> (Rod, Vec<f64>, Robot, Case, Vec<Option<Parameter>>) {
    let mut noise = Noise(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) + 1);
    for _ in 0..8 {
        noise.next();
    }
    let (young, nu, d, rho) = (1.1e9, 0.3, 0.003, 1040.0);
    let ei = young * PI / 64.0 * f64::powi(d, 4);
    let (force, moment) = (ei / (LENGTH * LENGTH), ei / LENGTH);
    let load = if loaded { 1.0 } else { 0.0 };
    let mut numbers = vec![young, nu, d, rho];
    numbers.extend((0..3).map(|_| noise.next() / LENGTH));
    numbers.extend((0..3).map(|_| load * 9.81 * noise.next()));
    numbers.extend((0..3).map(|_| load * force * noise.next()));
    numbers.extend((0..3).map(|_| load * 0.5 * moment * noise.next()));
    numbers.extend((0..3).map(|_| load * 0.5 * force * noise.next()));
    numbers.extend((0..3).map(|_| load * 0.3 * moment * noise.next()));
    let per_metre = if spread { 1.0 / LENGTH } else { 0.0 };
    for _ in 0..2 {
        numbers.extend((0..3).map(|_| per_metre * force * noise.next()));
        numbers.extend((0..3).map(|_| per_metre * 0.3 * moment * noise.next()));
    }
    let mut which = vec![
        Some(Parameter::YoungModulus),
        Some(Parameter::PoissonRatio),
        Some(Parameter::Diameter),
        Some(Parameter::Density),
    ];
    type ByAxis = fn(usize) -> Parameter;
    let by_axis: [ByAxis; 6] = [
        |axis| Parameter::RestCurvature { axis },
        |axis| Parameter::Gravity { axis },
        |axis| Parameter::TipForce { axis },
        |axis| Parameter::TipMoment { axis },
        |axis| Parameter::PointForce { load: 0, axis },
        |axis| Parameter::PointMoment { load: 0, axis },
    ];
    which.extend(by_axis.iter().flat_map(|p| (0..3).map(|axis| Some(p(axis)))));
    for load in 0..2 {
        let there = |parameter: Parameter| spread.then_some(parameter);
        which.extend((0..3).map(|axis| there(Parameter::LineForce { load, axis })));
        which.extend((0..3).map(|axis| there(Parameter::LineMoment { load, axis })));
    }
    let cables = 1 + seed as usize % 4;
    let (mut kinds, mut list, mut commands) = (Vec::new(), Vec::new(), Vec::new());
    for cable in 0..cables {
        let kind = (seed as usize + cable) % 4;
        kinds.push(kind);
        let (angle, radius) = (PI * noise.next(), 0.008 + 0.002 * noise.next());
        let tension = (0.3 + 0.2 * noise.next()) * ei / (LENGTH * radius);
        let (x, y) = (radius * angle.cos(), radius * angle.sin());
        let mut more = || 0.3 * radius * noise.next();
        let mut own = [tension, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let mut mine = vec![None; PER_CABLE];
        let routing = match kind {
            0 => {
                (own[1], own[2]) = (angle, radius);
                mine[1..3].copy_from_slice(&[
                    Some(Parameter::Angle { cable }),
                    Some(Parameter::Radius { cable }),
                ]);
                Routing::Straight { angle, radius }
            }
            1 => {
                (own[1], own[2], own[3]) = (angle, more() / radius, radius);
                mine[1..4].copy_from_slice(&[
                    Some(Parameter::Angle { cable }),
                    Some(Parameter::Turns { cable }),
                    Some(Parameter::Radius { cable }),
                ]);
                Routing::Helix { start_angle: angle, turns: own[2], radius }
            }
            2 => {
                (own[1], own[2], own[3], own[4]) = (x, y, x + more(), y + more());
                for axis in 0..2 {
                    mine[1 + axis] = Some(Parameter::Start { cable, axis });
                    mine[3 + axis] = Some(Parameter::End { cable, axis });
                }
                Routing::Linear { start: [x, y], end: [own[3], own[4]] }
            }
            _ => {
                let per = [1.0, 1.0 / LENGTH, 1.0 / (LENGTH * LENGTH)];
                for (axis, start) in [x, y].into_iter().enumerate() {
                    for power in 0..3 {
                        let at = 1 + 3 * axis + power;
                        own[at] = if power == 0 { start } else { more() * per[power] };
                        mine[at] = Some(Parameter::Coefficient { cable, axis, power });
                    }
                }
                Routing::Polynomial { x: own[1..4].to_vec(), y: own[4..7].to_vec() }
            }
        };
        numbers.extend(own);
        which.extend(mine);
        commands.push(CableCommand { tension: Some(tension), shortening: None });
        let ends_at = (cable == 1).then_some(0.5 * LENGTH);
        list.push(Cable { ends_at, ..Cable::new(format!("{cable}"), routing) });
    }
    let vector = |i: usize| Vec3::new(numbers[i], numbers[i + 1], numbers[i + 2]);
    let backbone = Backbone {
        section: Some(Section::circle(d)),
        material: Material {
            young_modulus: Some(young),
            poisson_ratio: Some(nu),
            density: Some(rho),
            ..Material::default()
        },
        rest_curvature: RestCurvature::Uniform(vector(4)),
        ..Backbone::new(LENGTH)
    };
    let robot = Robot::new(backbone, Disks::equally_spaced(LENGTH, 3, 0.01), list).unwrap();
    let loads = Loads {
        gravity: loaded.then(|| vector(7)),
        tip_force: vector(10),
        tip_moment: vector(13),
        points: vec![PointLoad {
            at: 0.5 * LENGTH,
            force: vector(16),
            moment: vector(19),
            follower: false,
        }],
        distributed: match spread {
            false => vec![],
            true => [false, true].map(|follower| along_all(&vector, follower)).to_vec(),
        },
        ..Loads::default()
    };
    let rod = Rod { kinds, by_length: false, follows: spread };
    (rod, numbers, robot, Case { commands, loads, ..Case::default() }, which)
}

/// What is spread along all of the rod, from the vectors by their place.
fn along_all(vector: &dyn Fn(usize) -> Vec3, follower: bool) -> DistributedLoad {
    let first = if follower { SPREAD + 6 } else { SPREAD };
    let (force, moment) = (vector(first), vector(first + 3));
    let profile = Profile::Constant { from: 0.0, to: LENGTH, force, moment };
    DistributedLoad { profile, follower }
}

/// Largest difference of a column, relative to its largest entry.
fn check(seed: u64, loaded: bool, by_length: bool, spread: bool) -> f64 {
    let (mut rod, mut numbers, robot, mut case, which) = random(seed, loaded, spread);
    let options =
        Options { accuracy: Accuracy::Tolerance(3e-12), residual: 1e-13, ..Options::default() };
    let model = Cosserat::new(&robot, &case.loads, &options).unwrap();
    let mut workspace = Workspace::default();
    let cables = rod.kinds.len();
    let mut solution = model.solve(&case, None, &mut workspace).unwrap();
    if by_length {
        rod.by_length = true;
        for (i, cable) in solution.cables.iter().enumerate() {
            let shortening = cable.initial_length - cable.length;
            numbers[RODS_OWN + PER_CABLE * i] = shortening;
            case.commands[i] =
                CableCommand { tension: None, shortening: Some(Shortening::Length(shortening)) };
        }
    }
    let parameters: Vec<Parameter> = which.iter().flatten().copied().collect();
    let derivatives;
    (solution, derivatives) = model
        .solve_with_derivatives(&case, Some(&solution), &parameters, &mut workspace)
        .unwrap_or_else(|e| panic!("robot {seed}: {e}"));
    let base = solution.base_wrench.unwrap().moment;
    let mut unknown = vec![base.x, base.y, base.z];
    if by_length {
        unknown.extend(solution.cables.iter().map(|cable| cable.tension.unwrap()));
    }
    if spread {
        // What is not dead of the force at the base.
        let of = |i: usize| Vec3::new(numbers[i], numbers[i + 1], numbers[i + 2]);
        let weight = numbers[3] * PI / 4.0 * numbers[2].powi(2) * LENGTH;
        let dead = of(7) * weight + of(10) + of(16) + of(SPREAD) * LENGTH;
        let turning = solution.base_wrench.unwrap().force - dead;
        unknown.extend([turning.x, turning.y, turning.z]);
    }
    // To the answer of this rod's own discretisation.
    let n: Vec<Dual> = numbers.iter().map(|x| c(*x)).collect();
    for _ in 0..3 {
        let x: Vec<Dual> = unknown.iter().map(|x| c(*x)).collect();
        let left = rod.shoot(&n, &x).miss.iter().map(|d| d.0).collect();
        let step = solve(rod.jacobian(&numbers, &unknown), left);
        unknown.iter_mut().zip(&step).for_each(|(x, d)| *x -= d);
    }
    let matrix = rod.jacobian(&numbers, &unknown);
    let mut number = 0;
    let mut worst: f64 = 0.0;
    for by in 0..numbers.len() {
        let change = match which[by] {
            Some(_) => {
                number += 1;
                derivatives.parameter(number - 1, Hold::Commands)
            }
            None if by >= RODS_OWN && (by - RODS_OWN).is_multiple_of(PER_CABLE) => {
                derivatives.command((by - RODS_OWN) / PER_CABLE)
            }
            None => continue,
        };
        let exact = rod.derivative(&numbers, &unknown, by, &matrix);
        let (mut off, mut size) = (0.0_f64, 0.0_f64);
        let mut compare = |a: f64, b: f64, unit: f64| {
            off = off.max((a - b).abs() / unit);
            size = size.max(b.abs() / unit);
        };
        for (place, (p, axes)) in [Place::Disk(1), Place::Tip].into_iter().zip(&exact.frames) {
            let twist = change.twist(place);
            // φ = ½ Σ aₖ × aₖ′ over the columns of R.
            let turn = axes.iter().fold([0.0; 3], |sum, a| {
                let (x, d) = (a.map(|q| c(q.0)), a.map(|q| c(q.1)));
                let part = cross(x, d);
                core::array::from_fn(|i| sum[i] + 0.5 * part[i].0)
            });
            for i in 0..3 {
                compare(twist.linear[i], p[i].1, LENGTH);
                compare(twist.angular[i], turn[i], 1.0);
            }
        }
        for i in 0..cables {
            compare(change.lengths()[i], exact.lengths[i].1, LENGTH);
            if by_length {
                compare(change.tensions()[i], exact.miss[3 + i].1, unknown[3 + i]);
            }
        }
        let relative = if size == 0.0 { off } else { off / size };
        assert!(
            relative < 1e-7,
            "robot {seed}, loaded {loaded}, by length {by_length}, spread {spread}, {:?} ({by}): {relative:.1e}",
            which[by]
        );
        worst = worst.max(relative);
    }
    worst
}

#[test]
fn dual_numbers_give_the_same_derivatives() {
    let robots = if cfg!(debug_assertions) { 1 } else { 5 };
    let mut worst: f64 = 0.0;
    for seed in 0..robots {
        for by_length in [false, true] {
            worst = worst.max(check(seed, seed % 3 != 2, by_length, false));
        }
    }
    println!("{robots} robots, both ways of driving: they differ by {worst:.1e} at most");
}

/// With forces and moments spread along the rod, some dead and some that turn with it.
#[test]
fn dual_numbers_give_the_same_derivatives_under_spread_loads() {
    let robots = if cfg!(debug_assertions) { 1 } else { 2 };
    let mut worst: f64 = 0.0;
    for seed in 0..robots {
        worst = worst.max(check(seed + 1, true, seed % 2 == 1, true));
    }
    println!("{robots} robots: they differ by {worst:.1e} at most");
}
