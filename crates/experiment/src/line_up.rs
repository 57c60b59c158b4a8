//! Channels of one rate whose starts are whole samples apart, lined up block by block.

/// Channels of a record, of which the first samples of those that start early are left out.
pub(crate) struct LineUp {
    channels: Vec<Waiting>,
    pub(crate) rate_hz: f64,
    /// Latest start \[s\].
    pub(crate) start_s: f64,
    /// True before the first samples.
    pub(crate) is_new: bool,
    /// Largest distance of a start from the samples of the others, in samples.
    pub(crate) fraction: f64,
}

/// Samples of a channel that wait for the others.
#[derive(Default)]
struct Waiting {
    samples: Vec<f64>,
    /// Samples still to be left out.
    early: u64,
}

impl LineUp {
    /// Channels at one rate with their starts \[s\]; `None` for starts that are not finite.
    pub(crate) fn new(rate_hz: f64, starts: &[f64]) -> Option<Self> {
        let start_s = starts.iter().copied().reduce(f64::max).filter(|start| start.is_finite())?;
        let apart: Vec<f64> = starts.iter().map(|start| (start_s - start) * rate_hz).collect();
        let fraction = apart.iter().map(|apart| (apart - apart.round()).abs()).fold(0.0, f64::max);
        let waiting = |apart: &f64| Waiting { early: apart.round() as u64, ..Waiting::default() };
        let channels = apart.iter().map(waiting).collect();
        Some(Self { channels, rate_hz, start_s, is_new: true, fraction })
    }

    /// True if a channel starts a sample or more after another.
    pub(crate) fn is_apart(&self) -> bool {
        self.channels.iter().any(|channel| channel.early > 0)
    }

    /// Adds a block of each channel, and returns the samples that all channels have.
    pub(crate) fn push(&mut self, blocks: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
        for (channel, block) in self.channels.iter_mut().zip(blocks) {
            let early = channel.early.min(block.len() as u64);
            channel.early -= early;
            if channel.samples.is_empty() && early == 0 {
                channel.samples = block;
            } else {
                channel.samples.extend_from_slice(&block[early as usize..]);
            }
        }
        let common = self.channels.iter().map(|channel| channel.samples.len()).min().unwrap_or(0);
        let take = |channel: &mut Waiting| {
            let rest = channel.samples.split_off(common);
            std::mem::replace(&mut channel.samples, rest)
        };
        self.channels.iter_mut().map(take).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_meet_at_the_latest_start() {
        let early: Vec<f64> = (0..20).map(f64::from).collect();
        let late: Vec<f64> = (7..25).map(f64::from).collect();
        for block in [1, 3, 8, 100] {
            let mut line_up = LineUp::new(10.0, &[0.0, 0.7]).unwrap();
            assert!(line_up.is_apart() && line_up.fraction < 1e-9);
            let mut found = [Vec::new(), Vec::new()];
            let blocks = |samples: &[f64]| -> Vec<Vec<f64>> {
                samples.chunks(block).map(<[f64]>::to_vec).collect()
            };
            let (mut first, mut second) = (blocks(&early).into_iter(), blocks(&late).into_iter());
            for _ in 0..20 {
                let next =
                    vec![first.next().unwrap_or_default(), second.next().unwrap_or_default()];
                for (found, common) in found.iter_mut().zip(line_up.push(next)) {
                    found.extend(common);
                }
            }
            let expected: Vec<f64> = (7..20).map(f64::from).collect();
            assert_eq!(found, [expected.clone(), expected], "{block}");
        }
    }
}
