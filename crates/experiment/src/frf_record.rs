//! Frequency response functions as a record that other programs read.

use asperity_measure::{
    Abscissa, Channel, ChannelQuantity, ChannelUnit, DegreeOfFreedom, FrfUnits, Origin, Record,
    Samples,
};
use asperity_signal::{Frf, FrfForm};

use crate::analysis::{Analysis, ResponseAnalysis};

impl Analysis {
    /// The averaged function and the kept ones of the hits, response by response, as channels of one
    /// record over frequency.
    ///
    /// The line at zero frequency is left out, where a receptance from an acceleration is not
    /// defined. In a universal file they are functions of type 4, frequency response function. Nodes
    /// and directions are those of the measured channels; where these have none, or equal ones, the
    /// responses are nodes 1 to n and the force is node n + 1, along z. With several responses the names begin
    /// with that of the response.
    ///
    /// - `in_parts`: real and imaginary parts as channels of their own, for formats without complex
    ///   samples.
    pub fn frf_record(&self, in_parts: bool) -> Record {
        let nodes = self.nodes();
        let mut channels = Vec::new();
        for (number, response) in self.responses.iter().enumerate() {
            let prefix = match self.responses.len() {
                1 => String::new(),
                _ => format!("{} ", response.name()),
            };
            let mut add = |name: String, description, frf| {
                channels.push(channel(format!("{prefix}{name}"), description, frf, &nodes[number]));
            };
            let report = &response.report;
            add(
                format!("average {}", report.settings.estimator.to_uppercase()),
                format!("average of {} hits", report.average.hits),
                &response.average.frf,
            );
            for hit in &response.frfs {
                let text = format!("peak force {:.4} N", hit.force_peak_n);
                add(format!("hit {}", hit.index), text, &hit.frf);
            }
        }
        if in_parts {
            channels = channels.into_iter().flat_map(parts).collect();
        }
        Record { channels, ..Record::default() }
    }

    /// Nodes of response and force of each response.
    fn nodes(&self) -> Vec<[DegreeOfFreedom; 2]> {
        // Node 0 is that of a channel without one.
        let own = |response: &ResponseAnalysis, at: usize| {
            let node = response.report.channels.get(at)?.node.clone();
            node.filter(|node| node.node != 0)
        };
        let number = |node| DegreeOfFreedom { entity: String::new(), node, direction: 3 };
        let known: Option<Vec<_>> = self.responses.iter().map(|one| own(one, 1)).collect();
        let is_distinct = |nodes: &Vec<DegreeOfFreedom>| {
            nodes.iter().enumerate().all(|(at, node)| !nodes[..at].contains(node))
        };
        let mut numbers = (1..).map(number);
        let numbered = self.responses.iter().zip(&mut numbers).map(|(_, node)| node).collect();
        let force = self.responses.first().and_then(|first| own(first, 0));
        let Some(force) = force.or_else(|| numbers.next()) else { return Vec::new() };
        let responses = known.filter(is_distinct).unwrap_or(numbered);
        responses.into_iter().map(|response| [response, force.clone()]).collect()
    }
}

/// Real and imaginary part of a complex channel; a real channel itself.
pub(crate) fn parts(whole: Channel) -> Vec<Channel> {
    let Samples::Complex(values) = &whole.samples else {
        return vec![whole];
    };
    let part = |name: &str, samples: Vec<f64>| Channel {
        name: format!("{} {name}", whole.name),
        samples: Samples::Real(samples),
        ..whole.clone()
    };
    vec![
        part("real", values.iter().map(|value| value.re).collect()),
        part("imag", values.iter().map(|value| value.im).collect()),
    ]
}

fn channel(
    name: String,
    description: String,
    frf: &Frf,
    [response_node, reference_node]: &[DegreeOfFreedom; 2],
) -> Channel {
    let response = match frf.form {
        FrfForm::Mobility => ChannelQuantity::Velocity,
        FrfForm::Accelerance => ChannelQuantity::Acceleration,
        _ => ChannelQuantity::Displacement,
    };
    let units = FrfUnits::si(response, ChannelQuantity::Force);
    let step = frf.frequency_hz.get(1).copied().unwrap_or(0.0);
    Channel {
        name,
        quantity: ChannelQuantity::Unknown,
        unit: ChannelUnit::of_text(&units.map(|units| units.text()).unwrap_or_default()),
        abscissa: Abscissa::Even { start: step, step, quantity: ChannelQuantity::Frequency },
        samples: Samples::Complex(frf.values.iter().skip(1).copied().collect()),
        origin: Origin {
            description,
            date: String::new(),
            response: Some(response_node.clone()),
            reference: Some(reference_node.clone()),
            frf: units,
            is_coherence: false,
        },
    }
}
