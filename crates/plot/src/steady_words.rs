//! A branch of steady responses in words: its peak, its special points, and the reason for an end.

use std::fmt::Write as _;

use asperity_simulation::steady::{
    BranchSummary, CondensationReason, IntegratedMotion, LevelSummary, SteadyMotion, SteadySummary,
    TerminationSummary, TimeCheck, TimeSweepSummary,
};

/// Bifurcations of one kind that are listed one by one; of more, the range is given.
const MOST_LISTED: usize = 4;

/// The peak of each amplitude, or the reason why there is none, and the special points, as lines of text.
pub fn branches(summary: &SteadySummary) -> String {
    let mut text = String::new();
    for (index, part) in summary.parts().enumerate() {
        let LevelSummary::Solved(branch) = part else { continue };
        let (value, unit) = (branch.load.value(), branch.load.unit());
        let other = if index < summary.levels.len() { String::new() } else { other_part(branch) };
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{value:>10} {unit}   {other}{}", peak(branch));
        let further = advice(branch).map(str::to_owned).into_iter();
        let further = further.chain([remarks(branch).join("; ")]);
        let checks = [branch.stable_peak_integrated.map(|found| from_own_state(&found))];
        let checks = checks.into_iter().flatten().chain(branch.verify.map(|found| check(&found)));
        for line in further.chain(checks) {
            let _ = writeln!(text, "{:14} {line}", "");
        }
    }
    for sweep in &summary.time_sweeps {
        let (value, unit) = (sweep.load.value(), sweep.load.unit());
        let _ = writeln!(text, "{value:>10} {unit}   {}", time_sweep(sweep));
    }
    text
}

/// The beginning of a remark about the other part of a branch.
pub fn other_part(branch: &BranchSummary) -> String {
    let hz = branch.start_frequency_hz.unwrap_or(f64::NAN);
    format!("another part of the branch, from {hz:.3} Hz on: ")
}

/// The peak inside a complete branch, or the reason why there is none.
pub fn peak(branch: &BranchSummary) -> String {
    let (Some(hz), Some(u1)) = (branch.peak_frequency_hz, branch.peak_amplitude_1_m) else {
        return "no response".to_owned();
    };
    let ratio = branch.displacement_ratio.unwrap_or(f64::NAN);
    let mut numbers = format!("{hz:.3} Hz   u1 {u1:.5e} m   u2/u1 {ratio:.5}");
    if branch.peak_is_stable == Some(false) {
        numbers += "   unstable";
        let stable = branch.stable_peak_frequency_hz.zip(branch.stable_peak_amplitude_1_m);
        if let Some((hz, u1)) = stable {
            let _ = write!(numbers, "; largest stable response {hz:.3} Hz   u1 {u1:.5e} m");
        }
    }
    if branch.peak_is_inside {
        return format!("peak {numbers}");
    }
    if let TerminationSummary::Reached = branch.end {
        return format!("no peak in the range; largest at its end   {numbers}");
    }
    format!("no peak: {}; largest before   {numbers}", end(branch))
}

/// The end of a branch, with its place and reason.
pub fn end(branch: &BranchSummary) -> String {
    let hz = branch.end_frequency_hz.unwrap_or(f64::NAN);
    let points = branch.points;
    match &branch.end {
        TerminationSummary::Reached => "complete".to_owned(),
        TerminationSummary::Returned => {
            "the branch turns back and leaves the range at its start".to_owned()
        }
        TerminationSummary::NotConverged => {
            format!("the branch ends at {hz:.3} Hz, where the iteration does not converge")
        }
        TerminationSummary::PointLimit => {
            format!(
                "the branch ends at {hz:.3} Hz after {points} points, the most that are followed"
            )
        }
        TerminationSummary::BeyondLaw { interface, closure_m } => format!(
            "the branch ends at {hz:.3} Hz, where {interface} would close by {closure_m:.3e} m and its law gives no finite pressure"
        ),
        _ => format!("the branch ends at {hz:.3} Hz"),
    }
}

/// A request that may give the peak, if this branch has none.
pub fn advice(branch: &BranchSummary) -> Option<&'static str> {
    if branch.peak_is_inside {
        return None;
    }
    Some(match branch.end {
        TerminationSummary::Reached | TerminationSummary::Returned => {
            "try a wider range of frequencies (--from, --to)"
        }
        TerminationSummary::BeyondLaw { .. } => "try a lower force (--amplitude)",
        _ if branch.contact_lost && branch.condensed_bodies.is_empty() => {
            "try condensed bodies (--bodies condensed) or fewer harmonics (--harmonics 7): with contact lost, high ones excite light bodies \
             between open contacts; or a lower force (--amplitude)"
        }
        _ => "try another number of harmonics (--harmonics), or the range from its other end",
    })
}

/// The bodies without inertia and the reason, if there are any.
fn condensed(branch: &BranchSummary) -> Option<String> {
    let reason = branch.condensed_because?;
    let bodies = branch.condensed_bodies.iter();
    let bodies: Vec<String> =
        bodies.map(|body| format!("{} ({:.4e} Hz)", body.name, body.frequency_hz)).collect();
    let reason = match reason {
        CondensationReason::ContactLost { from_hz } => {
            format!(", as contact is lost from about {from_hz:.0} Hz on with it")
        }
        _ => String::new(),
    };
    let share: f64 = branch.condensed_bodies.iter().map(|body| body.inertia_share).sum();
    let moved = if share > 0.0 {
        format!(", which moves frequencies by up to {:.1e}", 0.5 * share)
    } else {
        String::new()
    };
    Some(format!("inertia left out: {}{moved}{reason}", bodies.join(", ")))
}

/// The comparison with time integration.
pub fn check(check: &TimeCheck) -> String {
    let (hz, difference) = (check.frequency_hz, check.relative_difference);
    let scatter = check.scatter;
    match check.motion {
        SteadyMotion::Periodic => {
            format!("at {hz:.3} Hz differs from time integration by {difference:.1e}")
        }
        SteadyMotion::NonPeriodic | SteadyMotion::Subharmonic => format!(
            "at {hz:.3} Hz time integration gives a motion without the period of the force: its fundamental \
             scatters by {scatter:.1e} from period to period; the mean differs by {difference:.1e}"
        ),
        _ => format!(
            "at {hz:.3} Hz differs from time integration, which has not settled, by {difference:.1e}"
        ),
    }
}

/// The largest stable response by time integration from its own state.
pub fn from_own_state(check: &TimeCheck) -> String {
    let TimeCheck { frequency_hz, integrated_1_m, relative_difference, scatter, .. } = check;
    let becomes = match check.motion {
        SteadyMotion::Apart => {
            return format!(
                "the largest stable response, at {frequency_hz:.3} Hz, ends in time integration from it with the bodies apart"
            );
        }
        SteadyMotion::Periodic => "a periodic motion",
        SteadyMotion::Subharmonic => "a motion of several periods",
        SteadyMotion::NonPeriodic => "a motion without a period",
        SteadyMotion::NotSettled => "a motion that still changes",
        _ => "another motion",
    };
    format!(
        "the largest stable response, at {frequency_hz:.3} Hz, in time integration from it: {becomes}, u1 \
         {integrated_1_m:.5e} m, {relative_difference:.1e} off, scatter {scatter:.1e}"
    )
}

/// A motion by time integration from rest.
fn motion(found: &IntegratedMotion) -> String {
    let hz = found.frequency_hz;
    let words = match (found.motion, found.periods) {
        (SteadyMotion::Periodic, _) if found.lost_share.is_some_and(|share| share > 0.0) => {
            format!("periodic with loss of contact, u1 {:.5e} m", found.amplitude_1_m)
        }
        (SteadyMotion::Periodic, _) => {
            format!("periodic, u1 {:.5e} m", found.amplitude_1_m)
        }
        (SteadyMotion::Subharmonic, Some(periods)) => {
            format!(
                "repeats after {periods} periods of the force, mean u1 {:.5e} m",
                found.amplitude_1_m
            )
        }
        (SteadyMotion::NonPeriodic, _) => format!(
            "not periodic: u1 scatters by {:.1e} about {:.5e} m",
            found.scatter, found.amplitude_1_m
        ),
        (SteadyMotion::Apart, _) => "the bodies do not come together again".to_owned(),
        _ => format!("not settled: u1 scatters by {:.1e}", found.scatter),
    };
    format!("at {hz:.3} Hz from rest: {words}")
}

/// A stepped sine by time integration.
pub fn time_sweep(sweep: &TimeSweepSummary) -> String {
    let direction = sweep.direction;
    if let Some(error) = &sweep.error {
        return format!("stepped sine {direction}: {error}");
    }
    let (hz, a1) = (sweep.peak_frequency_hz, sweep.peak_amplitude_1_m);
    let (hz, a1) = (hz.unwrap_or(f64::NAN), a1.unwrap_or(f64::NAN));
    let jumps: Vec<String> =
        sweep.jumps_hz.iter().map(|[a, b]| format!("{a:.3} and {b:.3} Hz")).collect();
    let jumps = if jumps.is_empty() {
        "no jump".to_owned()
    } else {
        format!("jumps between {}", jumps.join(", "))
    };
    let settled = match sweep.unsettled {
        0 => "settled at every frequency".to_owned(),
        count => format!(
            "not settled at {count} of {} frequencies: the fundamental still changes by up to {:.1e}",
            sweep.frequencies, sweep.largest_change
        ),
    };
    format!(
        "stepped sine {direction} by time integration: largest {a1:.5e} m at {hz:.3} Hz; {jumps}; {settled}"
    )
}

/// Loss of contact, instability and bifurcations, a remark each.
pub fn remarks(branch: &BranchSummary) -> Vec<String> {
    let mut remarks = Vec::new();
    if let Some(hz) = branch.contact_lost_from_hz {
        remarks.push(format!("contact lost from {hz:.3} Hz on"));
    }
    remarks.extend(condensed(branch));
    if let Some(finer) = &branch.finer {
        remarks.push(format!(
            "with {} harmonics, of an estimated truncation of {:.0e}; the branch with {} does not cover the range and \
             ends at {:.3} Hz after {} points",
            branch.harmonics,
            branch.truncation,
            finer.harmonics,
            finer.end_frequency_hz,
            finer.points
        ));
    }
    if !branch.ranges_without_stable_hz.is_empty() {
        let ranges = branch.ranges_without_stable_hz.iter();
        let ranges: Vec<String> =
            ranges.map(|[from, to]| format!("{from:.3} to {to:.3} Hz")).collect();
        remarks.push(format!("no stable response is known from {}", ranges.join(", ")));
    }
    if !branch.motions.is_empty() {
        let all: Vec<String> = branch.motions.iter().map(motion).collect();
        remarks.push(format!("time integration {}", all.join("; ")));
    }
    match branch.unstable_points {
        Some(0) => remarks.push("stable".to_owned()),
        Some(count) => remarks.push(format!("unstable at {count} of {} points", branch.points)),
        None => remarks.push("stability not computed: a mode is too fast".to_owned()),
    }
    for (kind, one, several) in [
        ("fold", "fold", "folds"),
        ("period_doubling", "period doubling", "period doublings"),
        ("neimark_sacker", "Neimark-Sacker bifurcation", "Neimark-Sacker bifurcations"),
        ("branch_point", "branch point", "branch points"),
    ] {
        let found = branch.bifurcations.iter().filter(|found| found.kind == kind);
        let places: Vec<f64> = found.map(|found| found.frequency_hz).collect();
        if places.is_empty() {
            continue;
        }
        let name = if places.len() == 1 { one } else { several };
        remarks.push(if places.len() > MOST_LISTED {
            let lowest = places.iter().copied().fold(f64::INFINITY, f64::min);
            let highest = places.iter().copied().fold(0.0, f64::max);
            format!("{} {name} between {lowest:.3} and {highest:.3} Hz", places.len())
        } else {
            let list: Vec<String> = places.iter().map(|hz| format!("{hz:.3}")).collect();
            format!("{name} at {} Hz", list.join(", "))
        });
    }
    remarks
}
