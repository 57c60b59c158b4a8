//! `cargo xtask cluster`: a study on a real Slurm of two nodes on this machine.
//!
//! It starts munged, slurmctld and two slurmd in a temporary folder, without systemd, cgroups or a
//! database; sends the script of `asperity study slurm` for a study of 8 shards, which are more than an array
//! may have; kills one shard in its middle; waits for the job that joins all; and compares the bytes with those of one run. The
//! daemons end with the task.

use std::fmt::Write;
use std::fs::{self, File};
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail, ensure};
use serde_json::json;

/// Programs of Slurm and munge.
const PROGRAMS: [&str; 7] =
    ["munged", "slurmctld", "slurmd", "sbatch", "squeue", "sinfo", "scancel"];
/// Folders that may hold daemons beside those of PATH.
const DAEMONS: [&str; 2] = ["/usr/sbin", "/usr/local/sbin"];

const NODES: usize = 2;
const SHARDS: u64 = 8;
/// Numbers of an array of Slurm are below it: the shards are two arrays.
const MAX_ARRAY_SIZE: u64 = 6;
/// The shard that is killed.
const KILLED: u64 = 3;
const CHUNK_ROWS: u64 = 64;
const CHUNKS: u64 = 16 * SHARDS;

/// Longest wait for anything.
const PATIENCE: Duration = Duration::from_secs(900);
const PAUSE: Duration = Duration::from_millis(20);

/// Carries out the task; true if the bytes are the same.
pub(crate) fn run() -> Result<bool> {
    let missing: Vec<&str> =
        PROGRAMS.into_iter().filter(|program| find(program).is_none()).collect();
    if !missing.is_empty() {
        bail!(
            "no {}; this task needs Slurm and munge, and installs nothing. On Debian or Ubuntu: \
             apt-get install --no-install-recommends slurm-wlm munge",
            missing.join(", ")
        );
    }
    let root = crate::workspace::workspace_root();
    let built =
        Command::new(env!("CARGO")).args(["build", "--package", "asperity-cli"]).status()?;
    ensure!(built.success(), "the command is not built");
    let programs = fs::canonicalize(root.join("target/debug"))?;
    let scratch = tempfile::tempdir()?;
    let folder = scratch.path();
    write_study(&root, folder)?;
    let slurm = Slurm::start(folder, &programs)?;
    println!("slurmctld and {NODES} slurmd run in {}", folder.display());

    let script = slurm.asperity(&[
        "study",
        "slurm",
        "study.json",
        "--out",
        "shards",
        "--shards",
        &SHARDS.to_string(),
        "--cores",
        "1",
        "--memory",
        "100M",
        "--time",
        "30",
        "--retries",
        "2",
    ])?;
    fs::write(folder.join("job.sh"), script)?;
    let sent = slurm.output("bash", &["job.sh"])?;
    print!("{sent}");
    let arrays = sent.split(';').next().unwrap_or_default().split("job ").nth(1);
    let arrays = arrays.unwrap_or_default().split_whitespace().count() as u64;
    ensure!(
        arrays == SHARDS.div_ceil(MAX_ARRAY_SIZE - 1),
        "the shards were sent as {arrays} arrays"
    );
    slurm.kill_shard()?;
    println!("shard {KILLED} was killed in its middle");
    slurm
        .wait("the end of all jobs", || Ok(slurm.output("squeue", &["--noheader"])?.is_empty()))?;
    for entry in fs::read_dir(folder)?.flatten() {
        if entry.file_name().to_string_lossy().ends_with("-merge.log") {
            print!("{}", fs::read_to_string(entry.path())?);
        }
    }
    slurm.asperity(&["study", "study.json", "--out", "alone", "--quiet"])?;
    let table = |of: &str| {
        let path = folder.join(of).join("study.csv");
        fs::read(&path).with_context(|| format!("reading {}", path.display()))
    };
    let (sharded, alone) = (table("shards")?, table("alone")?);
    let same = sharded == alone;
    let words = if same { "the same bytes as" } else { "other bytes than" };
    println!("{SHARDS} shards give {words} one run: {} bytes", alone.len());
    Ok(same)
}

/// A study of quick hits whose shards take some seconds.
fn write_study(root: &Path, folder: &Path) -> Result<()> {
    let rig = fs::read_to_string(root.join("fixtures/scenarios/nouira2020-identified.json"))?;
    let study = json!({
        "schema": "asperity/study/1",
        "scenario": serde_json::from_str::<serde_json::Value>(&rig)?,
        "inputs": [{
            "pointer": "/excitation/peak_n", "name": "force",
            "distribution": {"kind": "uniform", "lower": 9, "upper": 32},
        }],
        "design": {"kind": "sobol", "rows": CHUNKS * CHUNK_ROWS},
        "chunk_rows": CHUNK_ROWS,
    });
    Ok(fs::write(folder.join("study.json"), study.to_string())?)
}

/// The file of a program.
fn find(program: &str) -> Option<PathBuf> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let folders = std::env::split_paths(&path).chain(DAEMONS.map(PathBuf::from));
    folders.map(|folder| folder.join(program)).find(|file| file.is_file())
}

/// Daemons of Slurm in a folder; they end when this is dropped.
struct Slurm {
    folder: PathBuf,
    path: std::ffi::OsString,
    daemons: Vec<Child>,
}

impl Slurm {
    fn start(folder: &Path, programs: &Path) -> Result<Self> {
        let old = std::env::var_os("PATH").unwrap_or_default();
        let folders = std::iter::once(programs.to_owned()).chain(std::env::split_paths(&old));
        let path = std::env::join_paths(folders.chain(DAEMONS.map(PathBuf::from)))?;
        let mut slurm = Self { folder: folder.to_owned(), path, daemons: Vec::new() };
        slurm.configure()?;
        slurm.munge()?;
        let conf = slurm.conf();
        slurm.daemon("slurmctld", &["-D", "-f", &conf])?;
        for node in 1..=NODES {
            slurm.daemon("slurmd", &["-D", "-N", &format!("n{node}"), "-f", &conf])?;
        }
        let idle = ["--noheader", "--Node", "--states=idle", "--format=%N"];
        slurm.wait("all nodes", || {
            // There is no answer before the controller is up.
            Ok(slurm.output("sinfo", &idle).is_ok_and(|nodes| nodes.lines().count() == NODES))
        })?;
        Ok(slurm)
    }

    fn conf(&self) -> String {
        self.folder.join("slurm.conf").display().to_string()
    }

    fn socket(&self) -> String {
        self.folder.join("munge/socket").display().to_string()
    }

    /// Writes slurm.conf.
    fn configure(&self) -> Result<()> {
        let place = |name: &str| self.folder.join(name).display().to_string();
        for name in ["munge", "state", "spool"] {
            fs::create_dir(self.folder.join(name))?;
        }
        let user = self.output("id", &["-un"])?.trim().to_owned();
        let host = self.output("uname", &["-n"])?.trim().to_owned();
        let host = host.split('.').next().unwrap_or_default();
        // Held together, so that all differ.
        let listeners =
            (0..=NODES).map(|_| TcpListener::bind("127.0.0.1:0")).collect::<Result<Vec<_>, _>>()?;
        let ports = listeners
            .iter()
            .map(|one| Ok(one.local_addr()?.port()))
            .collect::<Result<Vec<u16>>>()?;
        let mut text = format!(
            "ClusterName=asperity\n\
             SlurmctldHost={host}(127.0.0.1)\n\
             SlurmctldPort={}\n\
             SlurmUser={user}\n\
             SlurmdUser={user}\n\
             AuthType=auth/munge\n\
             AuthInfo=socket={},cred_expire=5\n\
             CredType=cred/munge\n\
             MpiDefault=none\n\
             ProctrackType=proctrack/linuxproc\n\
             TaskPlugin=task/none\n\
             JobAcctGatherType=jobacct_gather/none\n\
             AccountingStorageType=accounting_storage/none\n\
             SelectType=select/cons_tres\n\
             SelectTypeParameters=CR_Core\n\
             SchedulerParameters=batch_sched_delay=0,sched_interval=1,bf_interval=1\n\
             ReturnToService=2\n\
             MinJobAge=10\n\
             MaxArraySize={MAX_ARRAY_SIZE}\n\
             SlurmdParameters=config_overrides\n\
             CommunicationParameters=NoInAddrAny,NoCtldInAddrAny\n\
             StateSaveLocation={}\n\
             SlurmdSpoolDir={}/%n\n\
             SlurmctldPidFile={}\n\
             SlurmdPidFile={}-%n.pid\n",
            ports[0],
            self.socket(),
            place("state"),
            place("spool"),
            place("slurmctld.pid"),
            place("slurmd"),
        );
        for (node, port) in ports[1..].iter().enumerate() {
            let node = node + 1;
            fs::create_dir(self.folder.join(format!("spool/n{node}")))?;
            writeln!(
                text,
                "NodeName=n{node} NodeHostname={host} NodeAddr=127.0.0.1 Port={port} CPUs=2 \
                 RealMemory=1000 State=UNKNOWN"
            )?;
        }
        text += "PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP\n";
        Ok(fs::write(self.conf(), text)?)
    }

    /// Starts munged with a key of its own.
    fn munge(&mut self) -> Result<()> {
        // Its clients may be of any user.
        for folder in [".", "munge"] {
            self.output("chmod", &["755", folder])?;
        }
        self.output("dd", &["if=/dev/urandom", "of=munge/key", "bs=128", "count=1"])?;
        self.output("chmod", &["600", "munge/key"])?;
        let socket = self.socket();
        let place = |name: &str| self.folder.join("munge").join(name).display().to_string();
        let (key, pid) = (place("key"), place("pid"));
        let (log, seed) = (place("log"), place("seed"));
        self.daemon(
            "munged",
            &[
                "--foreground",
                "--socket",
                &socket,
                "--key-file",
                &key,
                "--pid-file",
                &pid,
                "--log-file",
                &log,
                "--seed-file",
                &seed,
            ],
        )?;
        self.wait("munged", || Ok(self.folder.join("munge/socket").exists()))
    }

    /// Starts a daemon in the foreground, with its output in a file.
    fn daemon(&mut self, program: &str, arguments: &[&str]) -> Result<()> {
        let log = File::create(self.folder.join(format!("{program}-{}.out", self.daemons.len())))?;
        let mut command = self.command(program, arguments);
        command.stdin(Stdio::null()).stdout(log.try_clone()?).stderr(log);
        self.daemons.push(command.spawn().with_context(|| format!("starting {program}"))?);
        Ok(())
    }

    fn command(&self, program: &str, arguments: &[&str]) -> Command {
        let file = find(program).unwrap_or_else(|| program.into());
        let mut command = Command::new(file);
        command.args(arguments).current_dir(&self.folder);
        command.env("PATH", &self.path).env("SLURM_CONF", self.conf());
        command
    }

    /// Standard output of a program.
    fn output(&self, program: &str, arguments: &[&str]) -> Result<String> {
        let output = self.command(program, arguments).output();
        let output = output.with_context(|| format!("running {program}"))?;
        let error = String::from_utf8_lossy(&output.stderr);
        ensure!(output.status.success(), "{program}: {}", error.trim_end());
        Ok(String::from_utf8(output.stdout)?)
    }

    fn asperity(&self, arguments: &[&str]) -> Result<String> {
        let file = std::env::split_paths(&self.path).next().context("a folder")?.join("asperity");
        self.output(&file.display().to_string(), arguments)
    }

    /// Kills a shard that has written chunks, but not its last.
    fn kill_shard(&self) -> Result<()> {
        let chunk = |number: u64| self.folder.join(format!("shards/chunks/{number:08}.csv"));
        let (second, last) = (KILLED - 1 + SHARDS, KILLED - 1 + CHUNKS - SHARDS);
        self.wait("the second chunk of a shard", || Ok(chunk(second).exists()))?;
        let shard = format!("{KILLED}/{SHARDS}");
        let id = process(&self.folder, &["--shard", &shard])?;
        let id = id.context("the shard ended before it could be killed")?;
        self.output("kill", &["-KILL", &id])?;
        ensure!(!chunk(last).exists(), "the shard was done before it was killed");
        Ok(())
    }

    fn wait(&self, what: &str, is_so: impl Fn() -> Result<bool>) -> Result<()> {
        let started = Instant::now();
        while !is_so()? {
            if started.elapsed() > PATIENCE {
                for entry in fs::read_dir(&self.folder)?.flatten() {
                    if entry.path().extension().is_some_and(|extension| extension == "out") {
                        eprintln!("{}", fs::read_to_string(entry.path())?);
                    }
                }
                bail!("{what}: not after {} s", PATIENCE.as_secs());
            }
            std::thread::sleep(PAUSE);
        }
        Ok(())
    }
}

impl Drop for Slurm {
    fn drop(&mut self) {
        let _ = self.output("scancel", &["--state=PENDING"]);
        let _ = self.output("scancel", &["--state=RUNNING"]);
        // Nodes before their controller.
        for daemon in self.daemons.iter_mut().rev() {
            let _ = daemon.kill();
            let _ = daemon.wait();
        }
    }
}

/// Id of the process in a folder with these arguments.
fn process(folder: &Path, arguments: &[&str]) -> Result<Option<String>> {
    let folder = fs::canonicalize(folder)?;
    for entry in fs::read_dir("/proc")?.flatten() {
        // A process may have ended meanwhile.
        let Ok(text) = fs::read(entry.path().join("cmdline")) else { continue };
        let words: Vec<_> = text.split(|byte| *byte == 0).map(String::from_utf8_lossy).collect();
        let has = |argument: &&str| words.iter().any(|word| word == argument);
        let is_here = fs::read_link(entry.path().join("cwd")).is_ok_and(|cwd| cwd == folder);
        if is_here && arguments.iter().all(has) {
            return Ok(Some(entry.file_name().to_string_lossy().into_owned()));
        }
    }
    Ok(None)
}
