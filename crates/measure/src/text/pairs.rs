//! LabVIEW files with an abscissa for each channel: `X_Columns` is `Multi`.
//!
//! Columns are pairs of abscissa and channel, with start and step of the channel in the header. Each
//! abscissa must be even; the axes of the channels may differ.

use crate::notice::Notices;
use crate::text::Text;
use crate::text::rows::RowBlock;
use crate::{Abscissa, Channel, MeasureError};

impl Text<'_> {
    /// The channels of a block of pairs.
    pub(crate) fn paired_channels(
        &mut self,
        rows: RowBlock,
        notices: &mut Notices,
    ) -> Result<Vec<Channel>, MeasureError> {
        let (mut values, last) = (rows.values, self.reader.source.line_place());
        if !values.len().is_multiple_of(2) {
            let found = format!("{} columns", values.len());
            let expected = "pairs of columns, as X_Columns is Multi";
            return Err(self.reader.source.malformed(last, "a row", &found, expected));
        }
        if self.axes.is_empty() {
            let pairs = self.reader.columns.chunks_exact(2).zip(values.chunks_exact(2));
            let pairs = pairs.zip(rows.roundings);
            let axes = pairs.enumerate().map(|(place, ((columns, values), rounding))| {
                let header = self.segment.axis(2 * place + 1);
                self.finder(columns, &header).find(values, rounding, notices)
            });
            self.axes = axes.collect::<Result<_, _>>()?;
        }
        let mut channels = Vec::with_capacity(values.len() / 2);
        let pairs = self.reader.columns.chunks_exact(2).zip(values.chunks_exact_mut(2));
        for (axis, (columns, values)) in self.axes.iter().zip(pairs) {
            let abscissa = axis.take_abscissa(values, self.rows, notices);
            if matches!(abscissa, Abscissa::Uneven { .. }) {
                let expected = "an even step in every block up to this line";
                let (quantity, name) = ("the X column of a channel", columns[1].name());
                let found = format!("uneven for {name}");
                return Err(self.reader.source.malformed(last, quantity, &found, expected));
            }
            channels.push(columns[1].channel(std::mem::take(&mut values[1]), abscissa));
        }
        Ok(channels)
    }
}
