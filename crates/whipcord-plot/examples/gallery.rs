//! Draws one of each picture, to be looked at: `cargo run --example gallery -- FOLDER`.

#[path = "../tests/common/mod.rs"]
mod common;

use std::error::Error;
use std::f64::consts::PI;
use std::path::Path;

use common::{arm, before, catheter, finger, prototype, towards, view};
use whipcord::{ModelKind, Vec3};
use whipcord_plot::{
    AccuracySeries, Colour, DistanceSeries, FigureOptions, Marker, RobotView, Scale, TimingSeries,
    ViewStyle, accuracy_chart, distance_chart, png, robot_figure, timing_chart,
};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| "gallery".to_owned());
    let folder = Path::new(&folder);
    std::fs::create_dir_all(folder)?;
    for (name, svg) in robots()?.into_iter().chain(charts()?) {
        std::fs::write(folder.join(format!("{name}.svg")), &svg)?;
        std::fs::write(folder.join(format!("{name}.png")), png(&svg, 2.0)?)?;
    }
    Ok(())
}

type Pictures = Vec<(&'static str, String)>;

fn robots() -> Result<Pictures, Box<dyn Error>> {
    let titled = |title: &str| FigureOptions { title: title.to_owned(), ..Default::default() };
    let mut pictures = Vec::new();

    let robot = prototype(&[1, 2, 3, 4, 4, 4, 4, 3, 2, 1])?;
    let pull = |s: f64| {
        let along = s / 0.18;
        PI / 6.0 * (9.0 * along).clamp(0.0, 3.0).min(9.0 - 9.0 * along)
    };
    let cosserat =
        view(&robot, "cosserat", ViewStyle::Model(ModelKind::Cosserat), |s| towards(pull(s), 8.7));
    let four_bar = view(&robot, "four-bar", ViewStyle::Model(ModelKind::FourBar), |s| {
        towards(pull(s) + 0.06, 8.2)
    });
    let views = [before(&robot), cosserat.clone(), four_bar];
    let measured = cosserat
        .disks
        .positions()
        .enumerate()
        .map(|(i, p)| p + Vec3::new(0.001, -0.0015, 0.001) * (i as f64 / 5.0))
        .collect();
    let options = FigureOptions {
        measured,
        ..titled("Case III: 400 gf on a cable through holes 1-2-3-4-4-4-4-3-2-1")
    };
    pictures.push(("case3", robot_figure(&robot, &views, &options)?));
    pictures.push(("case3_one", robot_figure(&robot, &views[..2], &titled("Case III"))?));

    let robot = prototype(&[4; 10])?;
    let planar = view(&robot, "cosserat", ViewStyle::Model(ModelKind::Cosserat), |_| {
        towards(PI / 2.0, PI / 2.0 / 0.18)
    });
    pictures.push(("case1", robot_figure(&robot, &[before(&robot), planar], &titled("Case I"))?));

    let robot = prototype(&[10, 10, 11, 12, 1, 2, 1, 12, 12, 1])?;
    let still = RobotView {
        style: ViewStyle::Model(ModelKind::Cosserat),
        label: "cosserat".into(),
        ..before(&robot)
    };
    let views = [before(&robot), still];
    pictures.push(("still", robot_figure(&robot, &views, &titled("No tension"))?));

    let robot = arm()?;
    let s_bend = |s: f64| if s < 1.0 { towards(0.4, 1.3) } else { towards(2.6, 1.9) };
    let bent = view(&robot, "cosserat", ViewStyle::Model(ModelKind::Cosserat), s_bend);
    pictures.push((
        "arm",
        robot_figure(&robot, &[before(&robot), bent], &titled("Two segments, six cables"))?,
    ));

    let robot = catheter()?;
    let hook = |s: f64| if s > 0.07 { towards(0.0, 60.0) } else { Vec3::ZERO };
    let hook = view(&robot, "cosserat", ViewStyle::Model(ModelKind::Cosserat), hook);
    pictures
        .push(("catheter", robot_figure(&robot, &[before(&robot), hook], &titled("Catheter"))?));

    let finger = finger()?;
    let curl = view(&finger, "cosserat", ViewStyle::Model(ModelKind::Cosserat), |s| {
        towards(40.0 * s, 120.0 * s + 40.0)
    });
    let views = [before(&finger), curl];
    pictures.push(("finger", robot_figure(&finger, &views, &titled("Helical finger of 60 mm"))?));
    Ok(pictures)
}

fn charts() -> Result<Pictures, Box<dyn Error>> {
    let mut pictures = Vec::new();
    let distances = |label: &str, end: f64| DistanceSeries {
        label: label.into(),
        disks: (1..=10).map(|k| (k, end * (k as f64 - 1.0).powf(1.6) / 33.6)).collect(),
        look: None,
        hollow: false,
    };
    let series = [
        distances("cosserat to four-bar", 3.1e-3),
        distances("cosserat to measured", 2.2e-3),
        distances("four-bar to measured", 1.7e-3),
    ];
    pictures.push(("distance", distance_chart("Case III: distance at each disk", &series)?));
    pictures.push(("distance_one", distance_chart("", &series[..1])?));
    let many: Vec<_> = (0..6)
        .map(|i| DistanceSeries {
            label: format!("case {i}, cosserat to four-bar"),
            disks: (1..=41).map(|k| (k, 1e-6 * (i + 1) as f64 * (k as f64).sqrt())).collect(),
            look: None,
            hollow: false,
        })
        .collect();
    pictures.push(("distance_many", distance_chart("Fine model", &many)?));

    let mut timings = Vec::new();
    for (m, (model, base, each)) in
        [("four-bar", 0.2e-6, 0.33e-6), ("cosserat", 2.9e-6, 0.07e-6)].into_iter().enumerate()
    {
        for (c, case) in ["I", "II", "III", "IV"].into_iter().enumerate() {
            let runs = [5, 10, 20, 40, 80, 160, 320]
                .into_iter()
                .flat_map(|n| (0..6).map(move |r| (n, r)))
                .map(|(n, r)| {
                    let noise =
                        1.0 + 0.03 * f64::from((7 * n as i32 + 13 * r + 5 * c as i32) % 9 - 4);
                    (n, (base + each * n as f64 * (1.0 + 0.1 * c as f64)) * noise)
                })
                .collect();
            timings.push(TimingSeries {
                label: format!("{model}, case {case}"),
                runs,
                look: Some((Colour::nth(m), Marker::nth(c))),
            });
        }
    }
    let title = "Time to solve against number of sections";
    pictures.push(("timing", timing_chart(title, &timings, Scale::Linear)?));
    pictures.push(("timing_log", timing_chart(title, &timings, Scale::Log)?));
    pictures.push((
        "timing_two",
        timing_chart("", &[timings[2].clone(), timings[6].clone()], Scale::Linear)?,
    ));

    let errors = |label: &str, at_one: f64, order: i32, floor: f64| AccuracySeries {
        label: label.into(),
        errors: [4, 8, 16, 32, 64, 128, 256]
            .into_iter()
            .map(|n| (n, at_one / (n as f64).powi(order) + floor))
            .collect(),
        look: None,
    };
    let series = [
        errors("cosserat, case III", 0.9, 4, 3e-14),
        errors("cosserat, case IV", 3.0, 4, 1e-14),
        errors("four-bar, case III", 0.4, 2, 0.0),
    ];
    pictures.push(("accuracy", accuracy_chart("Accuracy against steps", &series, &[2, 4])?));
    Ok(pictures)
}
