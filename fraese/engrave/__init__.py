"""Pictures and drawings made into programs: text, no machine.

    file --sources--> Drawing | Picture --placing--> paths, dots in mm
         --ways--> strokes --tools--> moves --program--> lines of G-code
                                            --preview--> a picture, dots in a terminal

Rule 1: a source knows no way, a way no tool, a tool no text: one more of each is one function and
        one row (``sources.SOURCES``, ``ways.WAYS``, ``tools.TOOLS``).
Rule 2: from the sources on all is in mm, with Y upwards.
Rule 3: the same file and the same words give the same program, byte by byte.
Rule 4: nothing that was in a file is left out in silence: it is noted.
"""
