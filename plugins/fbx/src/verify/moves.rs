//! Majorants of how far both poses are apart over a span between keys.

use super::actors::Actors;
use super::chain::{Chain, HARDLY, down, length};
use super::lengths::Lengths;
use super::played;
use crate::clips::SHELL;
use crate::curves::{Majorant, Over, Squares};
use crate::model::{Channel, Property};
use glam::{DMat3, DVec3};

/// Axes that differ by no more than this share are about as long.
const ALIKE: f64 = 1e-3;

impl Actors<'_> {
    /// The majorant of how far any point is off over a span between keys.
    pub(super) fn moves(&mut self, from: f64, to: f64) -> Majorant {
        let over = Over {
            from,
            to,
            slack: 1e-7 * (to - self.begin).abs() + 1e-9,
        };
        self.work += 8 * self.movers.len();
        let is_scaled = self.locals(over);
        // Of the poses only lengths of axes are asked, which mostly are the same at all times, or known: but for scales that stand
        // still in this span, and not in others.
        if self.posed.is_none() || !self.is_plain || is_scaled {
            self.pose(over.middle());
        }
        self.chains();
        self.lengths();
        let is_known = |&node: &usize| self.is_about_still(node) || self.lengths[node].off <= ALIKE;
        if !self.movers.iter().all(is_known) {
            self.pose(over.middle());
        }
        let posed = self.posed == Some(over.middle());
        let mut out = Majorant::ZERO;
        for &node in &self.movers {
            let shell = self.shell(node, posed);
            let moved = |chain: &Chain| chain.origin.plus_product(&chain.axes, &shell);
            let both = self.chains.each_ref().map(|chains| moved(&chains[node]));
            out = out.max(&both[0].plus(&both[1]));
        }
        out.max(&self.carried(over))
    }

    /// Majorants of what places each node below its parent, of the file and of the keys. Says whether a scale stands still that moves
    /// at other times.
    fn locals(&mut self, over: Over) -> bool {
        let mut is_scaled = false;
        // What nothing moves is still as it was at the begin.
        for (node, curves) in &mut self.curves {
            let rates = curves.over(over);
            let is_still = rates.scale.is_still();
            is_scaled |= is_still && curves.scales();
            self.squares[*node] = (!is_still).then(|| curves.squares_over(over));
            self.rates[0][*node] = rates;
        }
        let label = over.since(self.begin);
        for (channel, player) in self.channels.iter().zip(&mut self.players) {
            let rates = &mut self.rates[1][channel.node];
            match channel.property {
                Property::Translation => {
                    rates.translation = played::vector(channel, player, label).0;
                }
                Property::Rotation => rates.turn = played::turn(channel, player, label),
                Property::Scale => rates.scale = played::vector(channel, player, label).1,
                Property::Weights => {}
            }
        }
        is_scaled
    }

    /// Majorants of each node in the world.
    fn chains(&mut self) {
        let places = [(&self.true_world, &self.truth), (&self.world, &self.played)];
        let sides = self.rates.iter().zip(&mut self.chains).zip(places);
        for ((rates, chains), (world, pose)) in sides {
            down(
                self.shells,
                &self.movers,
                self.moving,
                rates,
                (world, pose),
                chains,
            );
        }
    }

    /// Majorants of how long the axes of nodes are that do not keep their lengths.
    fn lengths(&mut self) {
        // What scales below such nodes move is asked of them too.
        if self.movers.iter().all(|&node| self.is_about_still(node)) {
            return;
        }
        for &node in &self.movers {
            if self.chains[0][node].keeps {
                continue;
            }
            let still = |axes: &DMat3| (Lengths::still(axes), Majorant::still(length(axes)));
            let (above, axes) = match self.shells.parent(node) {
                None => still(&DMat3::IDENTITY),
                Some(parent) if self.moving[parent] => {
                    let chain = &self.chains[0][parent];
                    let lengths = match chain.keeps {
                        true => Lengths::still(&self.true_world[parent].matrix3),
                        false => self.lengths[parent],
                    };
                    (lengths, chain.axes)
                }
                Some(parent) => still(&self.true_world[parent].matrix3),
            };
            let scales = self.squares[node];
            let scales = scales.unwrap_or_else(|| Squares::still(self.truth[node].scale));
            self.lengths[node] = above.below(&axes, &self.rates[0][node], &scales);
        }
    }

    /// The lengths of a node's axes are the same at all times, or hardly change.
    fn is_about_still(&self, node: usize) -> bool {
        let chain = &self.chains[0][node];
        chain.keeps || chain.changes <= HARDLY
    }

    /// Of how far out the shell of a node is, in its own unit: as far as its axes are short. `posed` says that poses are those of the
    /// span's middle.
    fn shell(&self, node: usize, posed: bool) -> Majorant {
        let chain = &self.chains[0][node];
        let axes = &self.true_world[node].matrix3;
        let columns = || [axes.x_axis, axes.y_axis, axes.z_axis].map(DVec3::length);
        if self.is_about_still(node) {
            let columns = [axes.x_axis, axes.y_axis, axes.z_axis].map(DVec3::length_squared);
            let least = columns.into_iter().fold(f64::INFINITY, f64::min).sqrt();
            let far = SHELL / least.max(1e-9);
            return match chain.keeps {
                true => Majorant::still(far),
                false => chain.hardly_changes(far).unwrap_or(Majorant::UNKNOWN),
            };
        }
        let lengths = &self.lengths[node];
        // As they are in the middle of the span, or as they are known to be.
        let (columns, off) = match posed {
            true => (columns(), 0.0),
            false => (lengths.middles.map(f64::sqrt), lengths.off),
        };
        let of = |squared: &Majorant, shortest: f64, longest: f64| {
            let least = (shortest * shortest * (1.0 - off) - squared.1).max(0.0);
            let most = longest * longest * (1.0 + off) + squared.1;
            let [near, far] = [most, least].map(|square| SHELL / square.sqrt().max(1e-9));
            let mut moves = match least <= 1e-18 {
                true => Majorant::within(far, far),
                false => squared.reciprocal_root(least).scaled(SHELL),
            };
            moves.1 = moves.1.min(moves.0[1] / 2.0).min(far - near);
            moves
        };
        let ([x, y, z], [a, b, c]) = (columns, &lengths.squares);
        let (shortest, longest) = (x.min(y).min(z), x.max(y).max(z));
        // One for all where they are about as long.
        if longest - shortest <= ALIKE * shortest {
            return of(&a.max(b).max(c), shortest, longest);
        }
        let of = |squared: &Majorant, long: f64| {
            // As fast as the axes move, each is no longer than it is.
            let mut axis = chain.axes;
            axis.0[0] = (long * long * (1.0 + off) + squared.1).sqrt();
            of(&squared.min(&axis.product(&axis)), long, long)
        };
        of(a, x).max(&of(b, y)).max(&of(c, z))
    }

    /// Majorants of how far a point of a body that a node carries is moved.
    fn carried(&mut self, over: Over) -> Majorant {
        let mut out = Majorant::ZERO;
        let label = over.since(self.begin);
        for (number, weights) in &self.bodies {
            let body = &self.all.0[*number];
            // How far morph targets move vertices, in the file and by the keys.
            let mut morphs = [Majorant::ZERO; 2];
            if body.has_targets() {
                morphs = [
                    Majorant::still(body.reach(weights.wanted.iter().copied())),
                    Majorant::still(body.reach(weights.played.iter().copied())),
                ];
                let mut parts = Vec::new();
                let sum = |parts: &[Majorant]| {
                    let each = body.reaches().iter().zip(parts);
                    each.fold(Majorant::ZERO, |sum, (reach, part)| {
                        sum.plus(&part.scaled(*reach))
                    })
                };
                let morph = self.morphs.iter_mut().find(|morph| morph.mesh == body.mesh);
                if let Some(morph) = morph {
                    morph.curves.over(over, &mut parts);
                    morphs[0] = sum(&parts);
                }
                let weigh = |c: &&Channel| c.property == Property::Weights && c.node == body.node;
                let mut all = self.channels.iter().zip(&mut self.players);
                if let Some((channel, player)) = all.find(|(channel, _)| weigh(channel)) {
                    parts.clear();
                    played::numbers(channel, player, label, &mut parts);
                    morphs[1] = sum(&parts);
                }
            }
            for (node, far, longer) in body.levers() {
                let moved = |side: usize| {
                    let chain = match self.moving[node] {
                        true => self.chains[side][node],
                        false => Chain::still(&self.true_world[node]),
                    };
                    let reach = Majorant::still(far).plus_scaled(&morphs[side], longer);
                    chain.origin.plus_product(&chain.axes, &reach)
                };
                out = out.max(&moved(0).plus(&moved(1)));
            }
        }
        out
    }
}
