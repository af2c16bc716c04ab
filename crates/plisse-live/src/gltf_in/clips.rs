//! Clips: the channels of animations, repaired where their keys are doubled or out of order.

use std::ops::Range;

use gltf::animation::Property;
use plisse::{Error, Result};

use super::Reader;
use crate::model::{Channel, Clip, Interpolation, Target};

impl Reader<'_> {
    /// Adds all clips of `file`. A channel that cannot be read is left out, with a note: a clip
    /// that nobody asks for must not make a model unusable.
    pub(super) fn clips(&mut self, file: &gltf::Document) {
        for animation in file.animations() {
            let name =
                animation.name().map_or_else(|| animation.index().to_string(), str::to_owned);
            let mut clip = Clip { name: name.clone(), channels: Vec::new() };
            for channel in animation.channels() {
                let what = format!("clip \"{name}\", channel {}", channel.index());
                match self.channel(&channel, &what) {
                    Ok(channel) => clip.channels.extend(channel),
                    Err(error) => self.model.notes.push(left_out(&error)),
                }
            }
            self.model.clips.push(clip);
        }
    }

    /// One channel; `None` if it moves weights of a mesh without morph targets.
    fn channel(
        &mut self,
        channel: &gltf::animation::Channel<'_>,
        what: &str,
    ) -> Result<Option<Channel>> {
        let node = channel.target().node().index();
        let (target, width) = match channel.target().property() {
            Property::Translation => (Target::Translation(node), 3),
            Property::Rotation => (Target::Rotation(node), 4),
            Property::Scale => (Target::Scale(node), 3),
            Property::MorphTargetWeights => {
                let Range { start, end } = self.targets_of_node[node];
                if start == end {
                    return Ok(None);
                }
                (Target::Weights(start, end - start), end - start)
            }
        };
        let sampler = channel.sampler();
        let times = self.accessors.numbers(&sampler.input(), 1, what)?;
        let output_width = if matches!(target, Target::Weights(..)) { 1 } else { width };
        let values = self.accessors.numbers(&sampler.output(), output_width, what)?;
        let (interpolation, parts) = match sampler.interpolation() {
            gltf::animation::Interpolation::Step => (Interpolation::Step, 1),
            gltf::animation::Interpolation::Linear => (Interpolation::Linear, 1),
            gltf::animation::Interpolation::CubicSpline => (Interpolation::Cubic, 3),
        };
        let stride = parts * width;
        if times.is_empty() || values.len() != times.len() * stride {
            return self.bad(format!(
                "{what} has no keys, or not one value per key; export the file again"
            ));
        }
        let mut channel = Channel { target, interpolation, times, values };
        self.model.notes.extend(sort_keys(&mut channel, stride).map(|n| format!("{what}: {n}")));
        Ok(Some(channel))
    }
}

/// Puts the keys of `channel`, of `stride` numbers each, in order; a note if they were not. Of keys
/// at the same time, the value jumps from the first to the last.
fn sort_keys(channel: &mut Channel, stride: usize) -> Option<String> {
    let Channel { times, values, .. } = channel;
    let disordered = times.windows(2).filter(|t| t[1] < t[0]).count();
    if disordered > 0 {
        let mut order: Vec<usize> = (0..times.len()).collect();
        order.sort_by(|&a, &b| times[a].total_cmp(&times[b]));
        *values = order.iter().flat_map(|&k| values[k * stride..][..stride].to_vec()).collect();
        *times = order.iter().map(|&k| times[k]).collect();
    }
    let doubled = times.windows(2).filter(|t| t[1] == t[0]).count();
    match (disordered, doubled) {
        (0, 0) => None,
        (0, _) => {
            Some(format!("{doubled} key(s) have the time of the key before; the value jumps there"))
        }
        _ => Some(format!(
            "{disordered} key(s) were earlier than the key before; keys were sorted by time"
        )),
    }
}

/// The note on a channel that `error` makes unusable.
fn left_out(error: &Error) -> String {
    let text = match error {
        Error::Mesh { problem, .. } => problem.to_string(),
        other => other.to_string(),
    };
    let fault = text.split_once(';').map_or(text.as_str(), |(fault, _)| fault);
    format!("{fault}; the channel was left out")
}
