//! Job scripts for Slurm.

use std::path::Path;

use crate::error::StudyError;

/// Shards, resources and retries of a study on Slurm.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SlurmJob {
    /// Number of shards, each a task of the job array.
    pub shards: u64,
    /// Cores of a task.
    pub cores: u32,
    /// Memory of a task as Slurm takes it, such as 4G.
    pub memory: String,
    /// Longest time of a task as Slurm takes it, such as 04:00:00.
    pub time: String,
    /// Number of times that shards which are not finished are sent again.
    pub retries: u32,
}

/// Slurm's own limit of the numbers of an array, where the system does not tell its own.
const MAX_ARRAY_SIZE: u64 = 1001;

/// A script that sends the study in `file` to Slurm and calls itself there.
///
/// It sends a job array with a task for each shard, and a job that waits for the end of all tasks,
/// whatever it is, and joins the shards. Where some are not finished it sends those again, and
/// another job to join them, up to [`SlurmJob::retries`] times. Chunks on disk are kept. Shards beyond the
/// `MaxArraySize` of the system (1001 where it does not tell) are sent as several arrays.
///
/// # Errors
/// [`StudyError::Part`] for names that are not text or hold line breaks, and for a time or a memory
/// that Slurm does not take.
///
/// ```
/// use asperity_study::{SlurmJob, slurm_script};
///
/// let (memory, time) = ("4G".into(), "01:00:00".into());
/// let job = SlurmJob { shards: 8, cores: 4, memory, time, retries: 3 };
/// let script = slurm_script("rig study.json".as_ref(), "out/rig".as_ref(), &job)?;
/// assert!(script.contains("file='rig study.json'\nfolder='out/rig'\nshards=8\n"));
/// # Ok::<(), asperity_study::StudyError>(())
/// ```
pub fn slurm_script(file: &Path, folder: &Path, job: &SlurmJob) -> Result<String, StudyError> {
    let SlurmJob { shards, cores, memory, time, retries } = job;
    if time.is_empty() || !time.chars().all(|c| c.is_ascii_digit() || ":-".contains(c)) {
        let fault = format!("`{time}` is not a time; accepted: minutes, HH:MM:SS or D-HH:MM:SS");
        return Err(StudyError::Part { place: "time".into(), fault });
    }
    let number = memory.strip_suffix(['K', 'M', 'G', 'T']).unwrap_or(memory);
    if number.is_empty() || !number.chars().all(|c| c.is_ascii_digit()) {
        let fault =
            format!("`{memory}` is no memory; accepted: megabytes, or a number and K, M, G or T");
        return Err(StudyError::Part { place: "memory".into(), fault });
    }
    let (file, folder) = (quoted(file)?, quoted(folder)?);
    Ok(format!(
        r#"#!/bin/bash
# Sends a study to Slurm: bash SCRIPT, from the folder that these names start from.
#SBATCH --job-name=asperity-simulation
#SBATCH --requeue
set -eu
file={file}
folder={folder}
shards={shards}
retries={retries}

# Sends the shards of a list, and a job that joins all of them at their end. The numbers of an array end
# below MaxArraySize: more shards are sent as several arrays, each with the shards after the first
# `shift`.
send() {{
    limit=$(scontrol show config 2>/dev/null | sed -n 's/^MaxArraySize *= *\([0-9]*\).*/\1/p' || true)
    most=$((${{limit:-{MAX_ARRAY_SIZE}}} - 1))
    if [ "$most" -lt 1 ]; then
        echo "MaxArraySize of this Slurm is $limit: it takes no arrays; run the shards one by one" >&2
        exit 1
    fi
    lists=()
    for range in ${{1//,/ }}; do
        first=${{range%-*}}
        last=${{range#*-}}
        while [ "$first" -le "$last" ]; do
            number=$(((first - 1) / most))
            shift=$((number * most))
            end=$((shift + most))
            if [ "$end" -gt "$last" ]; then end=$last; fi
            part=$((first - shift))
            if [ "$end" -gt "$first" ]; then part=$part-$((end - shift)); fi
            lists[number]=${{lists[number]:+${{lists[number]}},}}$part
            first=$((end + 1))
        done
    done
    jobs=
    for number in "${{!lists[@]}}"; do
        array=$(sbatch --parsable --array="${{lists[number]}}" --cpus-per-task={cores} --mem={memory} \
            --time={time} --output=asperity-study-%A-%a.log "$0" shard $((number * most)))
        jobs=$jobs:${{array%%;*}}
    done
    merge=$(sbatch --parsable --dependency="afterany$jobs" --cpus-per-task=1 --mem={memory} \
        --time={time} --output=asperity-study-%j-merge.log "$0" merge "$2")
    echo "shards $1: job${{jobs//:/ }}; then job ${{merge%%;*}} joins them"
}}

case "${{1:-send}}" in
send)
    send "1-$shards" 0
    ;;
shard)
    exec asperity study "$file" --out "$folder" --shard "$((SLURM_ARRAY_TASK_ID + ${{2:-0}}))/$shards" \
        --threads "$SLURM_CPUS_PER_TASK"
    ;;
merge)
    left=$(asperity study unfinished "$folder" --shards "$shards") || left="1-$shards"
    if [ -z "$left" ]; then
        exec asperity study merge "$folder"
    fi
    if [ "$2" -ge "$retries" ]; then
        echo "shards $left are not finished after $2 retries; their logs say why" >&2
        exit 1
    fi
    send "$left" "$(($2 + 1))"
    ;;
esac
"#
    ))
}

/// A name as one word of a shell.
fn quoted(path: &Path) -> Result<String, StudyError> {
    match path.to_str() {
        Some(text) if !text.contains(['\n', '\r', '\0']) => {
            Ok(format!("'{}'", text.replace('\'', "'\\''")))
        }
        _ => Err(StudyError::Part {
            place: path.display().to_string(),
            fault: "a script cannot hold this name; accepted: text of one line".into(),
        }),
    }
}
