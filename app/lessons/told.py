"""What a lesson's text tells its reader to do, in the words of the language that is spoken: "Set **Cells** to `80`"."""

from app.language.spoken import later

#: Sentences by what is done. What is named stands in bold, its value as code, and the name before its value.
SENTENCES = {"Press": later("Press {name}"), "Set": later("Set {name} to {value}"),
             "Choose": later("Choose {name} {value}")}
#: Widgets that say a field of the scene, by the words that stand beside them.
FIELDS = {later("Cells"): "cells", later("Particles / cell"): "ppc", later("Amplitude A"): "amplitude",
          later("Modulus E"): "modulus", later("CFL number"): "cfl", later("Method"): "method",
          later("Body force"): "body_force"}
