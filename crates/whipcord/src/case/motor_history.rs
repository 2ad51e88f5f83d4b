//! What is left of earlier commands of motors: their turning points.

/// Commands of motors that were given before a step, without those that later ones have made irrelevant. The output of a drive
/// with backlash, eq. (2) of the page on motors, is the same after them, whatever its backlash, offset and gear ratio: a command
/// between its two neighbours has no effect, nor have two that lie between the one before and the one after them.
#[derive(Clone, Debug, Default)]
pub(super) struct MotorHistory {
    /// Of each motor.
    turning_points: Vec<Vec<f64>>,
    /// Steps that were added.
    pub taken: usize,
}

impl MotorHistory {
    /// Adds a step.
    pub fn push(&mut self, step: &[Option<f64>]) {
        if self.turning_points.len() < step.len() {
            self.turning_points.resize(step.len(), Vec::new());
        }
        for (points, command) in self.turning_points.iter_mut().zip(step) {
            if let &Some(command) = command {
                add(points, command);
            }
        }
        self.taken += 1;
    }

    /// Steps with the same effect.
    pub fn steps(&self) -> impl Iterator<Item = Vec<Option<f64>>> + '_ {
        let most = self.turning_points.iter().map(Vec::len).max().unwrap_or(0);
        (0..most).map(move |row| {
            let of_motor = |points: &Vec<f64>| {
                let place = (row + points.len()).checked_sub(most)?;
                points.get(place).copied()
            };
            self.turning_points.iter().map(of_motor).collect()
        })
    }
}

/// Adds a command, and removes those that it makes irrelevant.
fn add(points: &mut Vec<f64>, command: f64) {
    loop {
        let is_between = |value: f64, a: f64, b: f64| a.min(b) <= value && value <= a.max(b);
        match points.as_slice() {
            [.., before, last] if is_between(*last, *before, command) => _ = points.pop(),
            [.., before, first, second]
                if is_between(*first, *before, command)
                    && is_between(*second, *before, command) =>
            {
                points.truncate(points.len() - 2);
            }
            _ => break,
        }
    }
    points.push(command);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The drive's output after these commands, from rest.
    fn output(commands: impl Iterator<Item = f64>, backlash: f64, offset: f64) -> f64 {
        let half = 0.5 * backlash;
        let play = |before: f64, command: f64| {
            before.min(command - offset + half).max(command - offset - half)
        };
        commands.fold(0.0, play)
    }

    #[test]
    fn turning_points_leave_a_drive_where_all_commands_do() {
        // Linear congruences make numbers without a pattern; their sums wander.
        let mut seed = 1_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 40) as f64 / (1_u64 << 24) as f64 - 0.5
        };
        let (mut history, mut commands, mut longest) = (MotorHistory::default(), Vec::new(), 0);
        let mut command = 0.0;
        for step in 0..2000 {
            command = 0.95 * command + random();
            commands.push(command);
            // The other motor moves in every third step.
            history.push(&[Some(command), (step % 3 == 0).then_some(-command)]);
            let kept: Vec<f64> = history.steps().filter_map(|step| step[0]).collect();
            longest = longest.max(kept.len());
            for (backlash, offset) in [(0.0, 0.0), (0.1, 0.0), (0.7, 0.2), (2.0, -0.5), (9.0, 0.0)]
            {
                let all = output(commands.iter().copied(), backlash, offset);
                assert_eq!(output(kept.iter().copied(), backlash, offset), all);
            }
            let of_other = history.steps().filter_map(|step| step[1]);
            let all = commands.iter().step_by(3).map(|command| -command);
            assert_eq!(output(of_other, 0.7, 0.2), output(all, 0.7, 0.2));
        }
        assert!(longest < 30, "{longest}");
    }
}
