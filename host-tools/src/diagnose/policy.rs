//! Every threshold of the diagnosis, with its reason.
//!
//! Most were chosen on the shipped sets with a hidden effect and on blind sets
//! of seeds 1 to 6 (`cargo xtask study blind`), and judged on others; figures
//! are in `docs/results.md`. Where another study set one, it says so.

/// What the diagnosis decides by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Policy {
    /// A coordinate this many standard deviations off what the other rows
    /// predict is a gross error once the structure is modelled: with 10,000
    /// coordinates chance gets there twice in 100,000 sets.
    pub gross: f64,
    /// More flagged rows than this share...
    pub crowd_share: f64,
    /// ...and than so many are structure and no gross errors.
    pub crowd_rows: f64,
    /// Lambda is never lowered below this for corrections that are large all
    /// over: tolerances are then seven times wider than stated.
    pub least_lambda: f64,
    /// Residuals are at the noise floor when chi-square over degrees of freedom
    /// is within so many of its standard deviations of 1...
    pub floor_deviations: f64,
    /// ...or within this share: a sigma stated to one digit is 15 % off.
    pub floor_share: f64,

    /// Prior of a tool point, m: nothing is bolted on farther off.
    pub tool_prior: f64,
    /// Prior of a base, m or rad.
    pub base_prior: f64,
    /// Lines of a joint that a scan offers.
    pub lines_a_joint: usize,
    /// Wobbles of an axis that are looked for, up to so many times a turn.
    pub wobbles: usize,
    /// Probability from which on a name is worth a word.
    pub worth_a_word: f64,
    /// Odds of another explanation to the best from which on it is told.
    pub odds: f64,
    /// Halves whose coefficients differ with a smaller p value disagree.
    pub halves_disagree: f64,

    /// What an addition must be worth beyond its price, in units of chi-square:
    /// odds of fifty to one.
    pub worth: f64,
    /// Worth from which on an addition is tried, a later one dropped or
    /// exchanged.
    pub hint: f64,
    /// Rows from which on effects are told apart at once, and finer structure
    /// shows: then many terms are added one round after another.
    pub many_rows: usize,
    /// Explanations followed side by side with fewer rows.
    pub beam: usize,
    /// Refits tried from each.
    pub branches: usize,
    /// Of those, at most so many of one effect: look-alikes of other families
    /// must get a turn.
    pub of_one_effect: usize,
    /// Most effects in one such model.
    pub deepest: usize,
    /// Rounds with many rows.
    pub rounds: usize,
    /// Additions in one of them.
    pub together: usize,
    /// An addition of the same round must be worth this share of the best.
    pub share_of_best: f64,
    /// Orders of one joint added in one round are so many cycles a turn apart:
    /// the second may be the side lobe of the first.
    pub orders_apart: f64,
    /// Terms of the arm that are followed, however few the model may have.
    pub followed_terms: usize,
    /// A term whose Wald statistic is beyond so many times its price is kept
    /// without a refit.
    pub surely_kept: f64,
    /// Most exchanges of an addition for a better one where there is room for a
    /// few terms only.
    pub exchanges: usize,
    /// Share of a column that must survive the projection off the fitted model
    /// to count as seen.
    pub seen: f64,

    /// Lowest order scanned, cycles a turn: below lies eccentricity, and what a
    /// limited joint range cannot tell from geometry.
    pub lowest_order: f64,
    /// Peaks of a joint's scan that are sharpened.
    pub peaks: usize,
    /// A whole number of cycles is taken where it costs less than this in
    /// chi-square.
    pub whole_order: f64,
    /// Orders of one joint closer than this are one, cycles a turn.
    pub same_order: f64,

    /// Share of the structure that geometry leaves which names must explain, or
    /// a name would be forced: something else is at work. Few rows that stay
    /// above the noise floor tell nothing for sure...
    pub nameable_few: f64,
    /// ...and in many rows there is always something finer.
    pub nameable_many: f64,
    /// Share of it that an effect must carry to be named where something is left.
    pub strong: f64,
    /// Explanations this close, in units of chi-square, are not told apart: odds
    /// of a hundred to one.
    pub within_reach: f64,
    /// Poses proposed to tell two explanations apart...
    pub proposed: usize,
    /// ...out of so many tried...
    pub tried: usize,
    /// ...and so far from each other, rad or m over all joints.
    pub poses_apart: f64,
    /// A flagged row lies on the other side of a gap when moving it there leaves
    /// this share of its residual...
    pub gap_share: f64,
    /// ...or so many standard deviations.
    pub gap_deviations: f64,

    /// A dependence of the residuals weaker than this p value after correction
    /// is not worth a sentence.
    pub significant: f64,
    /// Share of the residuals of contradicting rows that one shift of a joint
    /// must explain to be told.
    pub slipped: f64,
    /// Share of all residuals that a step of a joint must explain to be told.
    pub step: f64,
}

/// What is in force.
pub const POLICY: Policy = Policy {
    gross: 6.0,
    crowd_share: 0.08,
    crowd_rows: 3.0,
    least_lambda: 0.02,
    floor_deviations: 5.0,
    floor_share: 0.3,
    tool_prior: 1.0,
    base_prior: 10.0,
    lines_a_joint: 5,
    wobbles: 4,
    worth_a_word: 0.02,
    odds: 0.01,
    halves_disagree: 1e-3,
    worth: 8.0,
    hint: 4.0,
    many_rows: 400,
    beam: 5,
    branches: 7,
    of_one_effect: 3,
    deepest: 6,
    rounds: 20,
    together: 4,
    share_of_best: 0.2,
    orders_apart: 3.0,
    followed_terms: 64,
    surely_kept: 4.0,
    exchanges: 12,
    seen: 1e-5,
    lowest_order: 2.6,
    peaks: 2,
    whole_order: 4.0,
    same_order: 0.4,
    nameable_few: 0.97,
    nameable_many: 0.7,
    strong: 0.05,
    within_reach: 9.2,
    proposed: 5,
    tried: 4000,
    poses_apart: 0.6,
    gap_share: 0.3,
    gap_deviations: 4.0,
    significant: 1e-3,
    slipped: 0.8,
    step: 0.2,
};
