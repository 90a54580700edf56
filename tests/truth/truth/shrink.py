"""Looks for the smallest scene that still shows a violation."""

import random
import time

from .tally import Tally

PATIENCE = 20.0


def shrink(chosen, violation, program, key):
    """Takes parts away from the violation's scene as long as a violation of its kind stays."""
    if not hasattr(violation.scene, "smaller"):
        return
    start = time.monotonic()
    going = True
    while going:
        going = False
        for smaller in violation.scene.smaller():
            if time.monotonic() - start > PATIENCE:
                return
            found = attempt(chosen, smaller, violation.kind, program, key)
            if found is not None:
                violation.told, violation.true, violation.bound = found.told, found.true, found.bound
                violation.command, violation.model, violation.scene = found.command, found.model, smaller
                going = True
                break


def attempt(chosen, scene, kind, program, key):
    """The violation of this kind in the scene, if there is one."""
    tally = Tally("attempt")
    tally.scene = scene
    try:
        chosen.check(scene, program, tally, random.Random(key))
    except (ValueError, ZeroDivisionError, IndexError, KeyError, AssertionError):
        return None
    return next((v for v in tally.violations if v.kind == kind), None)
