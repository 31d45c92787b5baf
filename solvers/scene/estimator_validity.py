"""Why an estimator is known not to hold, in sentences that several problems say."""

FROZEN_REASON = ("transport follows the errors of weights that are computed anew each step, and with frozen-weights "
                 "reads 2 to 20,000 times the error; leave that remedy out, or take recovered or companion")
PROCESSOR_REASON = ("{name} works on the particles in every step, which is not built for a GPU; take companion, which "
                    "the processor solves beside them, or --arch cpu")
REMEDIES_REASON = "the second run takes no remedies, so that it is a run of another method; leave them out"
