//! What a frame costs: a Kalman filter over `milliseconds = fixed + each · work`.
//!
//! It is recursive least squares with bounded forgetting (Kalman, 1960; Åström and Wittenmark, *Adaptive
//! Control*, 1995, chapter 2): the two numbers are a random walk, and what is not excited by the data
//! grows uncertain only up to a bound, so that a long rest does not make it burst. The work measured last
//! is the unit of work, so that both numbers are milliseconds of the present frame.

/// Drift of both numbers in a frame, standard deviation as a part of the time: 1.5 % a second at 60
/// frames a second. With 3 % of noise the filter then averages over some 15 frames.
const DRIFT: f64 = 0.002;
/// Most that either number can be unknown by, as a part of the time.
const MOST_UNKNOWN: f64 = 0.3;
/// How much a cut is expected to change the cost of a vertex, as a part of it.
const CUT_EACH: f64 = 0.08;
/// How much a change of load is expected to change all of the time, as a part of it.
const LOAD: f64 = 0.5;
/// How much either number may change by itself where something has changed that was not foreseen, as a
/// part of the time: it need not be a load, and the next frame with other work tells.
const SPLIT: f64 = 0.15;
/// Range of what the fixed time may change by at a cut, and the first guess, as parts of the time.
const CUT_FIXED: [f64; 2] = [0.02, 0.25];
const FIRST_CUT_FIXED: f64 = 0.08;
/// Range of the measured noise, and the first guess, as parts of the time.
const NOISE: [f64; 2] = [0.005, 0.08];
const FIRST_NOISE: f64 = 0.03;
/// A measurement farther off than so many standard deviations is not learnt from by itself.
const ALONE: f64 = 4.0;
/// The change detector (two-sided cumulative sum; Page, 1954): slack and threshold, in standard
/// deviations. Deviations are cut at [`ALONE`], so that one outlier never reaches the threshold and
/// two in sequence do; Siegmund's formula (1985) puts a false alarm at one in 4·10⁴ frames a side,
/// and it costs one step of some percent.
const SLACK: f64 = 0.75;
const THRESHOLD: f64 = 6.0;

/// What the work of a frame is known by; it says how time may depend on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Work {
    /// Counted for this view: time is a sum of two parts that are not negative.
    Known,
    /// 1/τ in place of it: the part that depends on it is the slope of time over τ, where the true
    /// exponent is between 0.3 and 1.6.
    Assumed,
}

impl Work {
    /// Least and greatest part of the time that the work may have.
    fn share(self) -> [f64; 2] {
        match self {
            Self::Known => [0.05, 1.0],
            Self::Assumed => [0.3, 1.6],
        }
    }

    /// The part taken before anything is known.
    fn first_share(self) -> f64 {
        match self {
            Self::Known => 0.8,
            Self::Assumed => 1.0,
        }
    }
}

/// What became of a measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Learnt {
    /// It refined the estimate.
    Refined,
    /// It is far off, alone so far, and was passed over.
    Outlier,
    /// With those before it, it says that the load has changed; the estimate is the new one.
    LoadChanged,
}

/// The estimate. All times are milliseconds.
#[derive(Clone, Copy, Debug)]
pub(super) struct CostModel {
    work: Work,
    /// Work that counts as 1.
    unit: f64,
    fixed: f64,
    each: f64,
    /// Covariance: of fixed, of both, of each.
    cov: [f64; 3],
    /// Variance of the noise, as a part of the time squared.
    noise: f64,
    /// Variance of the fixed time's change at a cut, likewise.
    cut_fixed: f64,
    /// Cumulative sums, above and below.
    sums: [f64; 2],
    /// Whether no frame since the last cut has been measured.
    fresh: bool,
}

impl CostModel {
    /// From the first measurement; work above 0.
    pub fn new(work: Work, amount: f64, milliseconds: f64) -> Self {
        let share = work.first_share();
        let unknown = MOST_UNKNOWN * milliseconds;
        let noise = FIRST_NOISE * milliseconds;
        // The sum is known to the noise, how it is split is not.
        let (split, sum) = (unknown * unknown, noise * noise);
        Self {
            work,
            unit: amount,
            fixed: (1.0 - share) * milliseconds,
            each: share * milliseconds,
            cov: [split, sum / 2.0 - split, split],
            noise: FIRST_NOISE * FIRST_NOISE,
            cut_fixed: FIRST_CUT_FIXED * FIRST_CUT_FIXED,
            sums: [0.0; 2],
            fresh: false,
        }
    }

    /// What the work is known by.
    pub fn work(&self) -> Work {
        self.work
    }

    /// Expected time of a frame with so much work.
    pub fn expected(&self, amount: f64) -> f64 {
        (self.fixed + self.each * amount / self.unit).max(0.0)
    }

    /// Standard deviation of what will be measured, noise and estimate together.
    pub fn deviation(&self, amount: f64) -> f64 {
        let time = self.expected(amount);
        (self.unknown(amount / self.unit) + self.noise * time * time).sqrt()
    }

    /// Standard deviation of the noise, as a part of the time.
    pub fn noise(&self) -> f64 {
        self.noise.sqrt()
    }

    /// Variance of the expected time.
    fn unknown(&self, w: f64) -> f64 {
        let [a, b, c] = self.cov;
        (a + w * (2.0 * b + w * c)).max(0.0)
    }

    /// Counts of work were in another unit than those from now on: `factor` new ones are one old one.
    pub fn rescale(&mut self, factor: f64) {
        self.unit *= factor;
    }

    /// Another view from now on.
    pub fn cut(&mut self, milliseconds: f64) {
        self.fresh = true;
        self.sums = [0.0; 2];
        match self.work {
            Work::Known => {
                self.cov[0] += self.cut_fixed * milliseconds * milliseconds;
                self.cov[2] += (CUT_EACH * self.each) * (CUT_EACH * self.each);
            }
            // Nothing is known of the new view's work: all may change together.
            Work::Assumed => self.scale_unknown(),
        }
    }

    /// All of the time may have changed by the same factor.
    fn scale_unknown(&mut self) {
        let variance = LOAD * LOAD;
        self.cov[0] += variance * self.fixed * self.fixed;
        self.cov[1] += variance * self.fixed * self.each;
        self.cov[2] += variance * self.each * self.each;
    }

    /// Learns from a frame that had so much work (above 0) and took so long (above 0).
    pub fn learn(&mut self, amount: f64, milliseconds: f64) -> Learnt {
        self.measure_by(amount);
        let time = self.expected(amount).max(milliseconds * 0.1);
        self.drift(time);
        let unknown = self.unknown(1.0);
        let noise = self.noise * time * time;
        let off = milliseconds - self.expected(amount);
        let deviations = off / (unknown + noise).sqrt();
        if self.fresh {
            // What the cut has changed, once the noise is taken off.
            let seen = ((off * off - noise) / (time * time)).max(0.0);
            let [least, most] = CUT_FIXED.map(|x| x * x);
            self.cut_fixed = (self.cut_fixed + 0.25 * (seen - self.cut_fixed)).clamp(least, most);
            self.fresh = false;
        } else {
            let cut = deviations.clamp(-ALONE, ALONE);
            self.sums[0] = (self.sums[0] + cut - SLACK).max(0.0);
            self.sums[1] = (self.sums[1] - cut - SLACK).max(0.0);
            if self.sums[0].max(self.sums[1]) > THRESHOLD {
                self.sums = [0.0; 2];
                self.scale_unknown();
                let split = (SPLIT * time) * (SPLIT * time);
                self.cov[0] += split;
                self.cov[2] += split;
                self.update(off, noise);
                return Learnt::LoadChanged;
            }
            if deviations.abs() > ALONE {
                return Learnt::Outlier;
            }
            if unknown < noise {
                // Measured only while the estimate itself is settled. 1/50: noise of a second.
                let seen = (off * off - unknown) / (time * time);
                let [least, most] = NOISE.map(|x| x * x);
                self.noise = (self.noise + 0.02 * (seen - self.noise)).clamp(least, most);
            }
        }
        self.update(off, noise);
        Learnt::Refined
    }

    /// Makes `amount` the unit: the same model, in which both numbers are of one size.
    fn measure_by(&mut self, amount: f64) {
        let factor = amount / self.unit;
        self.each *= factor;
        self.cov[1] *= factor;
        self.cov[2] *= factor * factor;
        self.unit = amount;
    }

    /// The random walk of one frame, and the bound of what is unknown.
    fn drift(&mut self, time: f64) {
        let walk = (DRIFT * time) * (DRIFT * time);
        self.cov[0] += walk;
        self.cov[2] += walk;
        let most = (MOST_UNKNOWN * time) * (MOST_UNKNOWN * time);
        // Scaling a row and its column alike keeps the matrix a covariance.
        for own in [0, 2] {
            if self.cov[own] > most {
                self.cov[1] *= (most / self.cov[own]).sqrt();
                self.cov[own] = most;
            }
        }
    }

    /// The filter's step, of a frame whose work is the unit.
    fn update(&mut self, off: f64, noise: f64) {
        let [a, b, c] = self.cov;
        let (towards_fixed, towards_each) = (a + b, b + c);
        let all = (towards_fixed + towards_each + noise).max(f64::MIN_POSITIVE);
        let gain = [towards_fixed / all, towards_each / all];
        self.fixed += gain[0] * off;
        self.each += gain[1] * off;
        self.cov = [
            (a - gain[0] * towards_fixed).max(0.0),
            b - gain[0] * towards_each,
            (c - gain[1] * towards_each).max(0.0),
        ];
        // What cannot be is put right so that the time of this work stays what it is.
        let time = (self.fixed + self.each).max(f64::MIN_POSITIVE);
        let [least, most] = self.work.share();
        self.each = self.each.clamp(least * time, most * time);
        self.fixed = time - self.each;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Times of a plant with fixed 1 ms and 2 ms a unit, and noise of known, even size.
    fn taught(noise: f64, frames: u32) -> CostModel {
        let mut model = CostModel::new(Work::Known, 1000.0, 3.0);
        for i in 0..frames {
            let work = 1000.0 * (1.0 + 0.3 * f64::from(i % 5));
            let sign = if (i / 5) % 2 == 0 { 1.0 } else { -1.0 };
            let time = (1.0 + 2.0 * work / 1000.0) * (1.0 + sign * noise);
            model.learn(work, time);
        }
        model
    }

    #[test]
    fn both_numbers_are_found_where_the_work_varies() {
        let model = taught(0.0, 200);
        // The floor of the noise, 0.5 %, keeps the filter averaging; there is no more to find.
        for (work, time) in [(500.0, 2.0), (1000.0, 3.0), (4000.0, 9.0)] {
            assert!((model.expected(work) / time - 1.0).abs() < 0.01, "{work}");
        }
    }

    #[test]
    fn noise_is_measured() {
        for noise in [0.01, 0.03, 0.06] {
            let model = taught(noise, 600);
            let found = model.noise();
            assert!((found / noise - 1.0).abs() < 0.3, "{noise}: {found}");
        }
    }

    #[test]
    fn a_lone_outlier_teaches_nothing_and_two_are_a_load() {
        let mut model = taught(0.02, 300);
        let before = model.expected(1500.0);
        assert_eq!(model.learn(1500.0, before * 1.5), Learnt::Outlier);
        assert_eq!(model.expected(1500.0), before);
        assert_eq!(model.learn(1500.0, before * 1.5), Learnt::LoadChanged);
        assert!((model.expected(1500.0) / (before * 1.5) - 1.0).abs() < 0.02);
        // The load is a factor of all: it holds for other work too.
        let other = taught(0.02, 300).expected(3000.0) * 1.5;
        assert!((model.expected(3000.0) / other - 1.0).abs() < 0.03);
    }

    #[test]
    fn a_long_rest_does_not_make_it_burst() {
        let mut model = taught(0.02, 100);
        for i in 0..100_000 {
            let sign = if i % 2 == 0 { 1.0 } else { -1.0 };
            model.learn(1000.0, 3.0 * (1.0 + 0.02 * sign));
        }
        let [a, _, c] = model.cov;
        assert!(a.max(c) <= (MOST_UNKNOWN * 3.1) * (MOST_UNKNOWN * 3.1));
        // 300 % more work: the split is known no better than the bound, the answer stays near.
        let far = model.expected(4000.0) / 9.0;
        assert!((0.6..1.4).contains(&far), "{far}");
    }

    #[test]
    fn a_cut_is_taken_in_at_once() {
        let mut model = taught(0.02, 300);
        let time = model.expected(1500.0);
        model.cut(time);
        assert_eq!(model.learn(1500.0, time * 1.2), Learnt::Refined);
        let found = model.expected(1500.0) / (time * 1.2);
        assert!((found - 1.0).abs() < 0.04, "{found}");
    }
}
