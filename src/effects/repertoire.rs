/// Makes of the table of effects everything that has a case for each: [`Effect`]
/// with what its descriptors say, the basis of a [`Term`] and [`FoldedTerms`].
/// All dispatch is by `match`; an image holds only the fields it reads.
macro_rules! repertoire {
    (
        effects { $($(#[$doc:meta])* $effect:ident in $module:ident,)+ }
        smooth { $($part:ident: $kind:ty,)+ }
    ) => {
        /// What an arm does beyond rigid geometry.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        pub enum Effect {
            $($(#[$doc])* $effect,)+
        }

        /// Codes are places in the table, and a blob has numbers for 64.
        const _: () = {
            let mut codes = 0;
            $(
                assert!($module::DESCRIPTOR.code == codes, "codes are given in order");
                codes += 1;
            )+
            assert!(codes <= 64, "a blob has no more codes");
        };

        impl Effect {
            /// Every effect; the place is its code.
            pub const ALL: &'static [Self] = &[$(Self::$effect,)+];

            /// Its code in a blob.
            #[must_use]
            pub const fn code(self) -> u8 {
                self as u8
            }

            /// The effect of a name.
            #[must_use]
            pub fn from_name(name: &str) -> Option<Self> {
                Self::ALL.iter().copied().find(|effect| effect.name() == name)
            }

            /// Name in reports and files.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self { $(Self::$effect => const { $module::DESCRIPTOR.name },)+ }
            }

            /// What its terms deflect.
            #[must_use]
            pub const fn acts_on(self) -> ActsOn {
                match self { $(Self::$effect => const { $module::DESCRIPTOR.acts_on },)+ }
            }

            /// Whether its terms follow another joint, their [`Term::source`].
            #[must_use]
            pub const fn is_coupled(self) -> bool {
                match self { $(Self::$effect => const { $module::DESCRIPTOR.coupled },)+ }
            }

            /// Names of components 0 and 1, such as cos and sin; empty where
            /// there is one coefficient only.
            #[must_use]
            pub const fn components(self) -> &'static [&'static str] {
                match self { $(Self::$effect => const { $module::DESCRIPTOR.components },)+ }
            }

            /// Whether a term may have component 1.
            pub(crate) const fn has_components(self) -> bool {
                match self {
                    $(Self::$effect => const { !$module::DESCRIPTOR.components.is_empty() },)+
                }
            }

            /// What the order of its terms is.
            #[must_use]
            pub const fn order(self) -> Order {
                match self { $(Self::$effect => const { $module::DESCRIPTOR.order },)+ }
            }

            /// Whether its terms depend on gravity.
            #[must_use]
            pub const fn load(self) -> NeedsLoad {
                match self { $(Self::$effect => const { $module::DESCRIPTOR.load },)+ }
            }

            /// Whether its terms depend on how the joint came to rest.
            #[must_use]
            pub const fn needs_approach(self) -> bool {
                match self { $(Self::$effect => const { $module::DESCRIPTOR.approach },)+ }
            }

            /// Whether its terms depend on the temperature.
            #[must_use]
            pub const fn needs_warmth(self) -> bool {
                match self { $(Self::$effect => const { $module::DESCRIPTOR.warmth },)+ }
            }

            /// Whether a joint of this kind may have it: what depends on turns
            /// of a joint is nothing of a sliding one. A blob may hold it, though.
            #[must_use]
            pub const fn suits(self, joint: JointKind) -> bool {
                let turns = matches!(joint, JointKind::Revolute);
                match self {
                    $(Self::$effect => turns || const { !$module::DESCRIPTOR.revolute_only },)+
                }
            }

            /// Unit of the coefficient for a joint and a source of these kinds.
            #[must_use]
            pub const fn unit(self, joint: JointKind, source: JointKind) -> &'static str {
                match self { $(Self::$effect => $module::DESCRIPTOR.units.of(joint, source),)+ }
            }

            /// A coefficient beyond this is no such effect but a wrong model.
            #[must_use]
            pub const fn plausible(self) -> f32 {
                match self { $(Self::$effect => const { $module::DESCRIPTOR.plausible },)+ }
            }

            /// What a coefficient changes by in the life of an arm, a scale for its prior.
            #[must_use]
            pub const fn usual(self) -> f32 {
                match self { $(Self::$effect => const { $module::DESCRIPTOR.usual },)+ }
            }
        }

        impl<T: Scalar> Term<T> {
            /// The known function that the coefficient multiplies.
            #[must_use]
            #[inline]
            pub fn basis<const N: usize>(&self, inputs: &TermInputs<T, N>) -> T {
                let value = match self.effect {
                    $(Effect::$effect => $module::basis(self, inputs),)+
                };
                value.unwrap_or(T::ZERO)
            }
        }

        /// Terms sorted at load time into what a tick has to compute. It gives
        /// what [`deflection`] gives, summed in another order.
        #[derive(Debug, Clone, PartialEq)]
        pub(crate) struct FoldedTerms<T, const N: usize> {
            $($part: $kind,)+
            waves: wave::Waves<T>,
            needs_load: bool,
            needs_torque: bool,
        }

        impl<T: Scalar, const N: usize> FoldedTerms<T, N> {
            /// Sorts terms; a joint that the arm does not have is ignored.
            #[must_use]
            pub fn new(terms: &Vec<Term<T>, MAX_TERMS>) -> Self {
                let mut out = Self {
                    $($part: <$kind>::none(),)+
                    waves: wave::Waves::none(),
                    needs_load: terms.iter().any(Term::needs_load),
                    needs_torque: terms.iter().any(Term::needs_torque),
                };
                for term in terms {
                    out.add(term);
                }
                out
            }

            #[inline(never)]
            fn add(&mut self, term: &Term<T>) {
                match term.effect { $(Effect::$effect => $module::fold(term, self),)+ }
            }

            /// What all but the periodic terms do: those which hardly change
            /// from the command to the corrected joints. In place of `out`: a tick has
            /// no time for copies.
            #[inline]
            pub(crate) fn smooth(&self, inputs: &TermInputs<T, N>, out: &mut Deflection<T, N>) {
                *out = Deflection::none();
                $(self.$part.bend(inputs, out);)+
            }
        }
    };
}
