//! The time left of an identification, from what it is expected to take and has taken so far.
//!
//! Evaluations of the model take the time that those so far took: the least on the points of a response
//! surface, which are evaluated many at a time, and in a search the geometric mean of least and mean, since the few far from
//! the optimum, whose hits open contacts, take up to 200 times as long and become rarer. Chains take what an evaluation of their surface takes on this
//! machine, until they have run once. How many evaluations a search needs, and how many surfaces a posterior, is known only at their
//! ends; the numbers here are about the medians of random rigs (`judgement_twins`), and a part that needs more than
//! expected is taken to need half as much again as so far.

use asperity_inference::{PosteriorOptions, Progress, Stage, SurfaceCost};

/// Evaluations that a search needs, over those of the derivatives at one point, from one start; and of a law without
/// an assumed form.
const SEARCH: f64 = 16.0;
const FREE_SEARCH: f64 = 10.0;

/// Those of a search that goes on with other standard deviations, and of one that begins at a better draw, over those of
/// the first search.
const CONTINUED: f64 = 0.4;
const REPEATED: f64 = 0.1;

/// Parameters without latents from which on a posterior usually needs more than one surface.
const MANY_PARAMETERS: usize = 7;

/// Share of the draws that a round evaluates: a part of them where the surface is poor.
const DRAWN: f64 = 0.6;

/// Time of exact derivatives at a point over the parameters, over the least time of an evaluation; on one thread.
const DERIVATIVES: f64 = 22.0;

/// The same of derivatives by differences, in evaluations.
const DIFFERENCES: f64 = 4.0;

/// Evaluations of a profile.
const PROFILE: f64 = 70.0;

/// Evaluations of the fit of a compared law over those of the derivatives at a point, and beside them.
const COMPARED: [f64; 2] = [18.0, 40.0];

/// Combinations of latents that data usually inform.
const INFORMED: usize = 16;

/// The usual number of evaluations of a part, over those so far, that needs more than was expected.
const OVERDUE: f64 = 1.5;

/// Evaluations of a search and of comparisons over those expected, and over those so far, that one in ten exceeds.
const LONG: f64 = 2.0;
const LONG_OVERDUE: f64 = 3.0;

/// Surfaces then.
const LONG_ROUNDS: Rounds = Rounds { second: 2.0, third: 2.0, again: 1.0 };

/// Least share of the time expected of chains that is left while they run.
const LEAST_LEFT: f64 = 0.1;

/// Weight of the newest evaluations in the least time of one.
const NEWEST: [f64; 2] = [0.1, 0.02];

/// Points in one call from which on the time of each is that of many at a time.
const MANY: usize = 8;

/// Evaluations, rounds and time that an identification is expected to take.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Forecast {
    search: f64,
    /// Derivatives after the search, in least times of an evaluation.
    derivatives: f64,
    pub(crate) profiles: f64,
    surface: SurfaceCost,
    draws: f64,
    rounds: Rounds,
    pub(crate) comparison: f64,
    /// Evaluations of a part, over those so far, that needs more than was expected.
    overdue: f64,
}

/// Parts of a posterior that may follow.
#[derive(Debug, Clone, Copy)]
struct Rounds {
    /// Surfaces after the first.
    second: f64,
    /// Chance of another surface after the second.
    third: f64,
    /// Chance that a draw is better than the fit, and derivatives and a surface come again.
    again: f64,
}

impl Rounds {
    /// Of a problem with so many parameters, of which some are latents: from 52 identifications of random rigs.
    fn of(parameters: usize, latents: usize) -> Self {
        match (parameters, latents) {
            (0..MANY_PARAMETERS, 0) => Self { second: 0.4, third: 0.3, again: 0.1 },
            (_, 0) => Self { second: 1.0, third: 0.8, again: 0.4 },
            _ => Self { second: 1.0, third: 0.6, again: 0.0 },
        }
    }

    /// Surfaces expected after one of this number.
    fn further(self, surface: usize) -> f64 {
        match surface {
            1 => self.second,
            2 => self.third,
            _ => 0.0,
        }
    }
}

/// Sizes of a problem.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sizes {
    pub(crate) parameters: usize,
    /// Latents among them.
    pub(crate) latents: usize,
    pub(crate) observations: usize,
    pub(crate) starts: usize,
    /// Laws in the comparison.
    pub(crate) compared: usize,
}

impl Forecast {
    pub(crate) fn new(sizes: Sizes, options: &PosteriorOptions) -> Self {
        let Sizes { parameters, latents, observations, starts, compared } = sizes;
        // A free law has one start, no profiles, and surfaces over the combinations that the data inform.
        let (others, free) = (parameters - latents, latents > 0);
        let stencil = |count: usize| (2 * count + 1) as f64;
        let threads = rayon::current_num_threads() as f64;
        Self {
            search: stencil(parameters) * if free { FREE_SEARCH } else { SEARCH * starts as f64 },
            derivatives: if free {
                DIFFERENCES * parameters as f64
            } else {
                DERIVATIVES * parameters as f64 * stencil(parameters) / threads
            },
            profiles: if free { 0.0 } else { PROFILE * others as f64 },
            surface: options.surface_cost(others + latents.min(INFORMED), observations),
            draws: options.draws as f64,
            rounds: Rounds::of(parameters, latents),
            comparison: compared as f64 * (COMPARED[0] * stencil(others) + COMPARED[1]),
            overdue: OVERDUE,
        }
    }

    /// The forecast that one identification in ten exceeds: long searches, and every part that may follow.
    pub(super) fn long(self) -> Self {
        Self {
            search: LONG * self.search,
            comparison: LONG * self.comparison,
            rounds: LONG_ROUNDS,
            overdue: LONG_OVERDUE,
            ..self
        }
    }
}

/// Evaluations that the explanations of a misfit need: short fits with a parameter more.
pub(crate) fn expected_of_explanations(parameters: usize) -> f64 {
    // Three of given numbers and usually three of losses, which end after five steps.
    6.0 * 5.0 * (2 * (parameters + 1) + 2) as f64
}

/// The part that is under way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum Moment {
    #[default]
    Search,
    Continued,
    Repeated,
    /// Derivatives and profiles.
    Profiles,
    /// Points of a surface.
    Surface,
    Chains,
    Draws,
    /// The end of a round: another surface follows, or the end.
    Drawn,
    Comparison,
}

/// Paces and numbers that were measured so far.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Measured {
    points: f64,
    seconds: f64,
    /// Least time of an evaluation, slowly forgotten \[s\].
    least: Option<f64>,
    chains_s: Option<f64>,
    training: Option<f64>,
    pub(super) moment: Moment,
    /// Evaluations in it.
    here: f64,
    /// Surfaces of the posterior.
    round: usize,
    /// True from where a draw was better than the fit.
    is_repeated: bool,
}

impl Measured {
    pub(super) fn begin(&mut self, moment: Moment) {
        (self.moment, self.here) = (moment, 0.0);
        if moment == Moment::Repeated {
            self.round = 0;
            self.is_repeated = true;
        }
    }

    /// Counts points that are evaluated.
    pub(super) fn count(&mut self, points: usize) {
        if self.moment == Moment::Drawn {
            self.begin(Moment::Surface);
        }
        self.here += points as f64;
    }

    /// Takes in that counted points took so many seconds together.
    pub(super) fn time(&mut self, points: usize, seconds: f64) {
        self.points += points as f64;
        self.seconds += seconds;
        if points >= MANY {
            let own = seconds / points as f64;
            self.least = Some(self.least.map_or(own, |least| {
                let weight = if own < least { NEWEST[0] } else { NEWEST[1] };
                least + weight * (own - least)
            }));
        }
    }

    /// Takes in the progress of a posterior, `since` seconds after its moment began.
    pub(super) fn follow(&mut self, now: &Progress, draws: f64, since: f64) {
        match now.stage {
            Stage::Surrogate => {
                self.training = Some(now.of as f64);
                self.round += 1;
                self.begin(Moment::Chains);
            }
            Stage::Sampling => {
                self.chains_s = Some(since);
                self.begin(Moment::Draws);
            }
            // More draws on the last surface are counted, rounds of surfaces are few.
            Stage::Draws if now.of as f64 > draws => self.begin(Moment::Draws),
            Stage::Draws => self.begin(Moment::Drawn),
            _ => {}
        }
    }

    /// Seconds left, `since` seconds after the moment under way began; none before the first evaluations.
    pub(super) fn seconds_left(&self, expected: &Forecast, since: f64) -> Option<f64> {
        if self.points == 0.0 {
            return None;
        }
        let mean = self.seconds / self.points;
        let least = self.least.unwrap_or(0.5 * mean);
        let searched = (mean * least).sqrt();
        let chains = self.chains_s.unwrap_or(expected.surface.chains_s);
        let training = self.training.unwrap_or(expected.surface.training as f64);
        let drawing = DRAWN * expected.draws * least;
        let round = training * least + chains + drawing;
        let end = expected.surface.diagnostics_s + expected.comparison * searched;
        let linear = expected.derivatives * least + expected.profiles * searched;
        let again = if self.is_repeated { 0.0 } else { expected.rounds.again };
        let again = again * (REPEATED * expected.search * searched + linear + round);
        // The surfaces after one, and the end.
        let after = |surface: usize| expected.rounds.further(surface) * round + again + end;
        let (now, next) = (self.round, self.round + 1);
        let searching =
            |count: f64| (count.max(expected.overdue * self.here) - self.here) * searched;
        let search = |share: f64| searching(share * expected.search) + linear + round + after(next);
        Some(match self.moment {
            Moment::Search => search(1.0),
            Moment::Continued => search(CONTINUED),
            Moment::Repeated => search(REPEATED),
            Moment::Profiles => {
                let left = (linear - since).max((expected.overdue - 1.0) * since).min(linear);
                left + round + after(next)
            }
            Moment::Surface => {
                (training - self.here).max(0.0) * least + chains + drawing + after(next)
            }
            Moment::Chains => (chains - since).max(LEAST_LEFT * chains) + drawing + after(now),
            Moment::Draws => (DRAWN * expected.draws - self.here).max(0.0) * least + after(now),
            // Each round but the last may have been enough.
            Moment::Drawn => {
                let further = expected.rounds.further(now).min(expected.rounds.third);
                further * round + again + end
            }
            Moment::Comparison => searching(expected.comparison),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sizes(parameters: usize, latents: usize) -> Sizes {
        Sizes { parameters, latents, observations: 100, starts: 2, compared: 0 }
    }

    /// Evaluations that were counted in fast identifications of random rigs: 171 to 1602 of laws with 5 to 10
    /// parameters, 463 to 1639 of free laws that reach their data without friction.
    #[test]
    fn searches_are_of_the_size_of_those_counted() {
        let search = |sizes| Forecast::new(sizes, &PosteriorOptions::default()).search;
        for (sizes, counted) in [
            (sizes(5, 0), 171.0..600.0),
            (sizes(10, 0), 400.0..1602.0),
            (sizes(43, 40), 463.0..1639.0),
        ] {
            assert!(counted.contains(&search(sizes)), "{sizes:?}: {}", search(sizes));
        }
    }

    impl Measured {
        fn add(&mut self, points: usize, seconds: f64) {
            self.count(points);
            self.time(points, seconds);
        }
    }

    #[test]
    fn parts_are_counted_down() {
        let forecast = Forecast {
            search: 100.0,
            derivatives: 10.0,
            profiles: 0.0,
            surface: SurfaceCost { training: 50, chains_s: 2.0, diagnostics_s: 1.0 },
            draws: 100.0,
            rounds: Rounds { second: 1.0, third: 0.5, again: 0.0 },
            comparison: 0.0,
            overdue: OVERDUE,
        };
        let mut now = Measured::default();
        assert_eq!(now.seconds_left(&forecast, 0.0), None);
        // Slow evaluations one by one, then many at a time: 0.1 and 0.02 s each.
        now.add(1, 0.1);
        now.add(10, 0.2);
        let searched = (0.3_f64 / 11.0 * 0.02).sqrt();
        let round = 50.0 * 0.02 + 2.0 + 60.0 * 0.02;
        let close = |found: Option<f64>, expected: f64| {
            let found = found.unwrap();
            assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        };
        close(now.seconds_left(&forecast, 0.3), 89.0 * searched + 0.2 + 2.0 * round + 1.0);
        now.begin(Moment::Profiles);
        close(now.seconds_left(&forecast, 0.1), 0.1 + 2.0 * round + 1.0);
        // Overdue: half as long again as so far, at most the whole.
        close(now.seconds_left(&forecast, 0.3), 0.15 + 2.0 * round + 1.0);
        now.begin(Moment::Surface);
        now.add(40, 0.8);
        close(now.seconds_left(&forecast, 0.8), 0.2 + 2.0 + 1.2 + round + 1.0);
        let of = |stage, done, of| Progress { stage, done, of, cost: f64::INFINITY };
        now.follow(&of(Stage::Surrogate, 60, 60), 100.0, 1.2);
        // The surface had ten points more than expected.
        let round = round + 10.0 * 0.02;
        close(now.seconds_left(&forecast, 1.0), 1.0 + 1.2 + round + 1.0);
        now.follow(&of(Stage::Sampling, 1, 3), 100.0, 3.0);
        let round = round + 1.0;
        now.add(20, 0.4);
        close(now.seconds_left(&forecast, 0.4), 40.0 * 0.02 + round + 1.0);
        now.follow(&of(Stage::Draws, 1, 3), 100.0, 0.6);
        close(now.seconds_left(&forecast, 0.0), 0.5 * round + 1.0);
        now.add(30, 0.6);
        close(now.seconds_left(&forecast, 0.6), 30.0 * 0.02 + 3.0 + 1.2 + 0.5 * round + 1.0);
        now.begin(Moment::Comparison);
        assert!(now.seconds_left(&forecast, 0.0).unwrap() < 0.1);
        // What may come again is expected once.
        let rounds = Rounds { again: 0.5, ..forecast.rounds };
        let often = Forecast { rounds, ..forecast };
        let [mut once, mut repeated] = [Measured::default(); 2];
        repeated.begin(Moment::Repeated);
        for now in [&mut once, &mut repeated] {
            now.add(10, 0.2);
            now.begin(Moment::Profiles);
        }
        let more = |now: &Measured| {
            now.seconds_left(&often, 0.0).unwrap() - now.seconds_left(&forecast, 0.0).unwrap()
        };
        let round = 50.0 * 0.02 + 2.0 + 60.0 * 0.02;
        assert!((more(&once) - 0.5 * (10.0 * 0.02 + 0.2 + round)).abs() < 1e-9);
        assert_eq!(more(&repeated), 0.0);
    }

    /// A recorded identification: what was expected, its seconds, and the events of its first half with their times.
    struct Recorded {
        expected: Forecast,
        seconds: f64,
        events: Vec<(f64, Vec<String>)>,
    }

    /// Identifications of random rigs, right and wrong models, as `time_left.csv` describes.
    fn recorded() -> Vec<Recorded> {
        let mut all: Vec<Recorded> = Vec::new();
        let lines = include_str!("../../tests/fixtures/time_left.csv").lines();
        for line in lines.filter(|line| !line.starts_with('#')) {
            let mut words = line.split(' ').map(str::to_owned);
            let first = words.next().unwrap();
            let words: Vec<String> = words.collect();
            let number = |place: usize| words[place].parse::<f64>().unwrap();
            if first == "run" {
                let surface = SurfaceCost {
                    training: number(3) as usize,
                    chains_s: number(4),
                    diagnostics_s: number(5),
                };
                let expected = Forecast {
                    search: number(1),
                    derivatives: number(2),
                    profiles: 0.0,
                    surface,
                    draws: number(6),
                    rounds: Rounds::of(number(7) as usize, number(8) as usize),
                    comparison: 0.0,
                    overdue: OVERDUE,
                };
                all.push(Recorded { expected, seconds: number(9), events: Vec::new() });
                continue;
            }
            all.last_mut().unwrap().events.push((first.parse().unwrap(), words));
        }
        all
    }

    impl Recorded {
        /// The time left, and the most, as they were told after a share of the whole, over the true one.
        fn told_after(&self, share: f64) -> [f64; 2] {
            let (mut now, mut begun) = (Measured::default(), 0.0);
            let at = share * self.seconds;
            for (time, words) in self.events.iter().take_while(|(time, _)| *time <= at) {
                let number = |place: usize| words[place].parse::<f64>().unwrap();
                let before = now.moment;
                let mut progress = |stage, of: f64| {
                    let progress =
                        Progress { stage, done: 0, of: of as usize, cost: f64::INFINITY };
                    now.follow(&progress, self.expected.draws, time - begun);
                };
                match words[0].as_str() {
                    "a" => now.add(number(1) as usize, number(2)),
                    "c" => now.begin(Moment::Continued),
                    "r" => now.begin(Moment::Repeated),
                    "P" => now.begin(Moment::Profiles),
                    "S" => now.begin(Moment::Surface),
                    "t" => progress(Stage::Surrogate, number(1)),
                    "s" => progress(Stage::Sampling, 0.0),
                    "d" => progress(Stage::Draws, number(1)),
                    other => panic!("{other}"),
                }
                if now.moment != before {
                    begun = *time;
                }
            }
            [self.expected, self.expected.long()].map(|expected| {
                now.seconds_left(&expected, at - begun).unwrap() / ((1.0 - share) * self.seconds)
            })
        }
    }

    /// The time left of recorded identifications, and the most, after a tenth, a quarter and a half of the time.
    #[test]
    fn the_time_left_of_recorded_identifications_is_mostly_within_a_factor_of_two() {
        let all = recorded();
        let holds = |share: f64, is_held: fn([f64; 2]) -> bool| {
            all.iter().filter(|one| is_held(one.told_after(share))).count()
        };
        let shares = [0.1, 0.25, 0.5];
        let within = shares.map(|share| holds(share, |[left, _]| (0.5..=2.0).contains(&left)));
        let below = shares.map(|share| holds(share, |[_, most]| most >= 1.0));
        // A most that is always far above holds too.
        let tight = shares.map(|share| holds(share, |[left, most]| most <= 3.0 * left));
        println!("{within:?}, {below:?} and {tight:?} of {}", all.len());
        for (found, least) in
            [(within, [0.85, 0.8, 0.8]), (below, [0.9, 0.9, 0.9]), (tight, [0.9, 0.9, 0.75])]
        {
            let least = least.map(|share: f64| (share * all.len() as f64) as usize);
            let are_kept = found.iter().zip(least).all(|(found, least)| *found >= least);
            assert!(are_kept, "{found:?} of {}", all.len());
        }
    }
}
