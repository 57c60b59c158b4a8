//! Job scripts for Slurm.

use std::path::Path;

use crate::error::EnsembleError;

/// Script of a job array with one task a shard. Each task that has finished its shard tries to join
/// all: the last one succeeds, and a task that is requeued or sent again goes on where it was.
///
/// # Errors
/// [`EnsembleError::Part`] for names that are not text or hold line breaks.
///
/// ```
/// let script = asperity_ensemble::slurm_script(
///     "rig study.json".as_ref(), "out/rig".as_ref(), 8, 4, "01:00:00",
/// )?;
/// assert!(script.contains("#SBATCH --array=1-8\n"));
/// assert!(script.contains("asperity study 'rig study.json' --out 'out/rig'"));
/// # Ok::<(), asperity_ensemble::EnsembleError>(())
/// ```
pub fn slurm_script(
    file: &Path,
    folder: &Path,
    shards: u64,
    cores: u32,
    time: &str,
) -> Result<String, EnsembleError> {
    let time_is_plain =
        !time.is_empty() && time.chars().all(|c| c.is_ascii_digit() || ":-".contains(c));
    if !time_is_plain {
        let fault = format!("`{time}` is not a time; accepted: minutes, HH:MM:SS or D-HH:MM:SS");
        return Err(EnsembleError::Part { place: "time".into(), fault });
    }
    let (file, folder) = (quoted(file)?, quoted(folder)?);
    Ok(format!(
        "#!/bin/bash\n\
         # Send with: sbatch SCRIPT, from the folder that these names start from.\n\
         # Shards that failed are sent again with: sbatch --array=K,... SCRIPT\n\
         #SBATCH --job-name=asperity-study\n\
         #SBATCH --array=1-{shards}\n\
         #SBATCH --cpus-per-task={cores}\n\
         #SBATCH --time={time}\n\
         #SBATCH --requeue\n\
         #SBATCH --output=asperity-study-%A-%a.log\n\
         set -eu\n\
         asperity study {file} --out {folder} --shard \"$SLURM_ARRAY_TASK_ID/{shards}\" \
         --threads \"$SLURM_CPUS_PER_TASK\"\n\
         # Fails until every shard is there, which is no fault of this one.\n\
         asperity study merge {folder} || true\n"
    ))
}

/// A name as one word of a shell.
fn quoted(path: &Path) -> Result<String, EnsembleError> {
    match path.to_str() {
        Some(text) if !text.contains(['\n', '\r', '\0']) => {
            Ok(format!("'{}'", text.replace('\'', "'\\''")))
        }
        _ => Err(EnsembleError::Part {
            place: path.display().to_string(),
            fault: "a script cannot hold this name; accepted: text of one line".into(),
        }),
    }
}
