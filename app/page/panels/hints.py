"""What the lines and columns of the readout mean, for who rests on them."""

from app.language.spoken import later

#: Of a line.
HINTS = {
    later("time"): later("simulated time since the start, and in periods of the exact vibration"),
    later("steps"): later("time steps taken, and how long each is"),
    later("step"): later("the time step over the longest that the present configuration bears by linear theory; above "
                         "1 it breaks"),
    later("solver"): later("how fast the kernels run, waiting not counted, and on what"),
    later("speed"): later("periods of the vibration in a second of yours: reached, of those asked for"),
    later("shown"): later("an earlier frame, of those that the slider Look back goes through"),
    later("kinetic energy"): later("of all particles, ± twice the error that the estimator on the stage says it has"),
    later("mean stress"): later("over the body at rest, ± twice the error that the estimator on the stage says it has"),
    later("verdict"): later("a run is ok if its positions are; this is as wrong as it is large"),
    later("unseen"): later("what the verdict does not rest on"),
    later("region"): later("mean and worst error of the particles in a rectangle that you drag on the stage"),
}
#: And of a column, or of several lines.
NORM = later("root of the mean square over the particles, now")
INDEX = later("error index: estimated over true, summed over the run so far; 1 is perfect")
DISTANCE = later("what the estimate misses, direction and all, over the true error; 0 is perfect")
WORST = later("where the root mean square of the error is largest, by the estimate on the stage and in truth")
