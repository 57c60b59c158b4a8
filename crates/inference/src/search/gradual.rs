//! Searches whose standard deviations fall to those as given.

use super::{Known, Search, run, run_all};
use crate::fit_options::FitOptions;
use crate::fit_problem::FitProblem;
use crate::progress::{ProgressCallback, Stage};

/// Factor by which the standard deviations of a stage are below those of the one before, and below the residuals at its
/// end.
const FALL: f64 = 2.0;
/// Factor of the standard deviations up to which they are taken as given.
const LAST: f64 = 1.5;
/// Reduction of the cost, over the cost, at which a stage ends.
const STAGE_TOLERANCE: f64 = 1e-2;
/// Most steps of a stage: what it leaves, the next one finds.
const STAGE_STEPS: usize = 30;

/// Runs searches one after the other, each in stages: with the standard deviations times the root mean square residual at
/// the start, with smaller and smaller ones, and at last as they are given.
///
/// Far from the data the directions that change them most have to be found first: with standard deviations of the size of
/// the residuals they alone outweigh the priors. Parameters without a prior have one about the start of each stage, so
/// that none is lost where it has no effect yet.
pub(crate) fn run_gradually(
    problem: &FitProblem<'_>,
    searches: &mut [Search],
    options: &FitOptions,
    stage: Stage,
    progress: &ProgressCallback<'_>,
) {
    for search in searches.iter_mut() {
        // A start without predictions is the search's own to tell.
        if let Some(Ok(predictions)) = problem.predict(std::slice::from_ref(&search.x)).pop() {
            let known = Known { x: search.x.clone(), predictions, slopes: Vec::new() };
            *search = through_stages(problem, known, options, stage, progress);
        }
    }
    run(problem, searches, options, stage, progress);
}

/// The search at the end of the stages before the last.
fn through_stages(
    problem: &FitProblem<'_>,
    mut known: Known,
    options: &FitOptions,
    stage: Stage,
    progress: &ProgressCallback<'_>,
) -> Search {
    let loose = FitOptions {
        tolerance: STAGE_TOLERANCE.max(options.tolerance),
        max_iterations: STAGE_STEPS.min(options.max_iterations),
        ..*options
    };
    let (mut iterations, mut evaluations) = (0, 1);
    let mut factor = residual(problem, &known);
    while factor > LAST {
        let scaled = problem.with_noise_factor(factor).held_near(&known.x);
        let mut search = [Search::at(&scaled, &loose, known)];
        run_all(&[&scaled], &mut search, &loose, stage, progress);
        let [search] = search;
        iterations += search.iterations;
        evaluations += search.evaluations;
        known = search.known();
        factor = residual(problem, &known).min(factor) / FALL;
    }
    let search = Search::at(problem, options, known).until_confirmed();
    Search { iterations, evaluations, ..search }
}

/// Root mean square residual with the standard deviations as given.
fn residual(problem: &FitProblem<'_>, known: &Known) -> f64 {
    let squares = problem.residuals(&known.predictions).iter().map(|r| r * r).sum::<f64>();
    (squares / problem.observations.len() as f64).sqrt()
}
