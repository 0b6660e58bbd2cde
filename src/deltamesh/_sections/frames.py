"""Section of the frames beyond the first: each predicted from the one before, as it is decoded.

Nothing accumulates, since the encoder predicts from what a decoder has. A key frame is predicted
from frame 0 alone, so that the frames after it need none of those before it.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final

import numpy as np

from deltamesh._content import Content, frame_digest
from deltamesh._geometry import anchors as choice
from deltamesh._geometry.bounds import Bounds
from deltamesh._geometry.frames import decode_frame, relative
from deltamesh._geometry.integers import NO_POINTS, Integers
from deltamesh._geometry.motion import Motion, fitted_motion
from deltamesh._geometry.prediction import Prediction, Reference, at_step, finer, predicted
from deltamesh._geometry.step_search import close_enough, fit_step
from deltamesh._geometry.trial import Attempt, Trial
from deltamesh._measures.margins import MOST_HALVINGS
from deltamesh._measures.metrics import diagonal, single_above
from deltamesh._methods import AUTO
from deltamesh._options import Settings
from deltamesh._sections.draft import Draft, FrameResult
from deltamesh._sections.trials import Trials
from deltamesh_formats.container.container import Container, Parameters, laid_out
from deltamesh_formats.container.frame_table import Frame, write_frames
from deltamesh_formats.container.layout import MAPS, MAX_FINER
from deltamesh_formats.errors import FormatError, MeshError, SolveError, TargetError

# Shares of the vertices that are cells of maps, and how coarse deltas may be: the likeliest first.
SHARES: Final = (0.01, 0.02, 0.005, 0.0)
COARSE: Final = (8.0, 12.0)
# The largest factor by which one trial of a Cartesian frame makes its step smaller.
FURTHEST: Final = 32.0


def encode(draft: Draft) -> tuple[bytes, Draft]:
    """Return the payload of FRAM, and the draft with what became of the frames."""
    assert draft.systems is not None
    plan = _Plan(draft)
    frames: list[Frame] = []
    results: list[FrameResult] = []
    margin, last, before = draft.margin, plan.first, draft.mesh.vertices
    scale = diagonal(draft.positions)
    for i, vertices in enumerate(draft.sequence.positions, start=1):
        is_key = _is_key(i, draft.sequence.key_every)
        trials = Trials(draft, vertices, draft.systems, f"frame {i}")
        reference = plan.first if is_key else last
        moves, before = not np.array_equal(vertices, before), vertices
        trial, prediction = plan.encoded(i, trials, reference, moves=moves)
        frames.append(_frame(i, trial, prediction, is_key, trials.scale))
        results.append(FrameResult(i, trial.measured, trials.cost(trial)))
        margin = _finer_margin(margin, trials.margin(trial), trials.scale / scale if scale else 0)
        last = Reference(trial.parameters, trial.integers, trial.vertices, trial.measured.doubt)
    payload = write_frames(draft.sequence.rate, frames, plan.first.parameters.method)
    return payload, replace(draft, frames=tuple(results), margin=margin)


def _finer_margin(margin: int, other: int, size: float) -> int:
    """Return a margin that is within one of frame 0, and within one of a frame of another size.

    Margins are halvings of the diagonal, 0 for none; `size` is the diagonal of the frame over that
    of frame 0, of which the result is.
    """
    if not (margin and other and size):
        return 0
    own = math.ceil(other - math.log2(size))
    return max(margin, own) if own <= MOST_HALVINGS else 0


def _is_key(index: int, key_every: int) -> bool:
    """Return whether a frame is a key frame; frame 1 has frame 0 before it in any case."""
    return index > 1 and index % key_every == 0


class _Plan:
    """Settings of the frames, once one that moves has shown which need the fewest bytes.

    Parameters
    ----------
    draft : Draft
    """

    def __init__(self, draft: Draft) -> None:
        chosen = draft.chosen
        p, i, doubt = chosen.parameters, chosen.integers, chosen.measured.doubt
        self._options = draft.options
        self._settings = replace(chosen.settings, bits=None, step=p.step)
        self._share = SHARES[0]
        self._is_settled = draft.options.effort == 1 or not self._settings.layout.anchored
        self.first = Reference(p, i, chosen.vertices, doubt)

    def encoded(
        self, index: int, trials: Trials, reference: Reference, *, moves: bool
    ) -> tuple[Trial, Prediction]:
        """Return the trial of a frame that is good enough, and what it is predicted from.

        A frame that `moves`, from the one before it in the input, shows which settings are good.

        Raises
        ------
        MeshError, TargetError
            If no trial is; they name the frame.
        """
        still = None if moves else self._still(trials, reference)
        if still is not None:
            return still
        try:
            best = self._tried(trials, reference, self._settings, self._share)
            if moves and not self._is_settled:
                best = self._settled(trials, reference, best)
        except (MeshError, SolveError, TargetError) as error:
            raise type(error)(f"frame {index}: {error}") from error
        self._settings = replace(self._settings, step=best[0].parameters.step)
        return best

    def _still(self, trials: Trials, reference: Reference) -> tuple[Trial, Prediction] | None:
        """Return the trial that leaves a frame where its reference is, if that keeps the bounds."""
        if trials.bounds is None or not self._settings.layout.anchored:
            return None
        prediction = predicted(
            trials.surface, self.first.parameters, reference, None, trials.systems
        )
        trial = trials.unmoved(self._settings, prediction)
        return (trial, prediction) if trials.bounds.excess(trial.measured) <= 1 else None

    def _settled(
        self, trials: Trials, reference: Reference, best: tuple[Trial, Prediction]
    ) -> tuple[Trial, Prediction]:
        """Return the smallest of the trials with other settings, too, and keep these."""
        self._is_settled = True
        for share in SHARES[1:]:
            best = self._smaller(trials, reference, best, self._settings, share)
        if self._settings.layout.coarse and not self._options.coarse and trials.bounds is not None:
            for coarse in COARSE:
                finer = math.sqrt(self._settings.coarse / coarse)
                step = best[0].parameters.step * finer
                settings = replace(self._settings, coarse=coarse, step=step)
                best = self._smaller(trials, reference, best, settings, self._share)
        return best

    def _smaller(
        self,
        trials: Trials,
        reference: Reference,
        best: tuple[Trial, Prediction],
        settings: Settings,
        share: float,
    ) -> tuple[Trial, Prediction]:
        found = self._tried(trials, reference, settings, share)
        if found[0].size >= best[0].size:
            return best
        self._settings, self._share = settings, share
        return found

    def _tried(
        self, trials: Trials, reference: Reference, settings: Settings, share: float
    ) -> tuple[Trial, Prediction]:
        """Return the trial of the largest step that keeps the bounds."""
        surface, bounds = trials.surface, trials.bounds
        motion = _motion(trials, reference, share) if settings.layout.anchored else None
        prediction = predicted(surface, self.first.parameters, reference, motion, trials.systems)

        def attempt(settings: Settings) -> Trial:
            return trials.as_decoded(trials.attempt(settings, prediction), prediction)

        if bounds is None:
            return attempt(settings), prediction
        if bounds.has_angle or settings.largest < math.inf:
            settings = replace(settings, largest=bounds.max)
        missed: list[Trial] = []
        if settings.layout.anchored:
            assert settings.step is not None
            close = close_enough(self._options.effort, surface.vertex_count)
            found = fit_step(settings, bounds, settings.step, close, attempt, None, missed)
        else:
            found = _on_coarsest_grid(settings, self.first.parameters.step, bounds, attempt, missed)
        if found is None and self._options.method != AUTO and not self._options.is_bounded:
            found = missed[-1] if missed else None
        if found is None:
            raise trials.missed(missed)
        return found, prediction


def _motion(trials: Trials, reference: Reference, share: float) -> Motion | None:
    """Return the motion from the reference to the frame of the trials, of a share of the vertices.

    There is none where nothing turns.
    """
    surface, n = trials.surface, trials.used
    if not share or not n:
        return None
    components = int(surface.labels.max(initial=-1)) + 1
    count = choice.count_anchors(share, n, components)
    cells = trials.systems.cells_apart(count)
    return fitted_motion(reference.vertices[:n], trials.positions[:n], cells)


def _on_coarsest_grid(
    settings: Settings, step: float, bounds: Bounds, attempt: Attempt, missed: list[Trial]
) -> Trial | None:
    """Return the first trial within the bounds on grids that halve that of frame 0."""
    halved = 0
    while halved <= MAX_FINER:
        trial = attempt(replace(settings, step=math.ldexp(step, -halved)))
        excess = bounds.excess(trial.measured)
        if excess <= 1:
            return trial
        missed[:] = [trial]
        # Errors are nearly proportional to steps: what is far beyond the bounds is halved at once.
        halved += max(1, int(math.log2(min(excess, FURTHEST))))
    return None


def _frame(index: int, trial: Trial, prediction: Prediction, is_key: bool, scale: float) -> Frame:
    """Return a frame as the container has it."""
    motion, errors = prediction.motion, trial.measured.errors
    seen = relative(trial.parameters, trial.integers, prediction.reference)
    return Frame(
        index=index,
        is_key=is_key,
        finer=finer(prediction.first, trial.parameters),
        step=trial.parameters.step,
        coarse=trial.parameters.coarse,
        rms=single_above(errors.rms / scale if scale else 0.0),
        max=single_above(errors.max / scale if scale else 0.0),
        normal=errors.normal_deviation,
        dihedral=errors.dihedral,
        maps=0 if motion is None else motion.count,
        rounds=0 if motion is None else motion.rounds,
        unit=0 if motion is None else motion.unit,
        digest=frame_digest(NO_POINTS if motion is None else motion.rows, seen),
        sections=laid_out(trial.payloads, 0),
        offset=0,
        size=0,
    )


def frame_integers(
    container: Container, content: Content, frame: Frame
) -> tuple[Motion | None, Integers]:
    """Return the motion of a frame, and its integers relative to another's.

    Raises
    ------
    FormatError
        If no encoder has written its streams, or the digest is another.
    """
    surface = content.structure.surface
    components, most = int(surface.labels.max(initial=-1)) + 1, surface.vertex_count
    if frame.maps and not components <= frame.maps <= most:
        offset = frame.sections[MAPS].offset
        raise FormatError(f"frame {frame.index}: {frame.maps} maps of {most} vertices", offset)
    first, parameters = content.integers, frame_parameters(container, frame)
    rows, integers = decode_frame(surface, parameters, frame.sections, first, frame.maps)
    if frame.maps and not rows.any():
        reason = f"frame {frame.index}: {MAPS}: no map moves anything"
        raise FormatError(reason, frame.sections[MAPS].start)
    if frame_digest(rows, integers) != frame.digest:
        offset = frame.offset
        reason = f"frame {frame.index}: the checksum of the decoded integers is wrong"
        raise FormatError(reason, offset)
    motion = Motion(rows, frame.rounds, frame.unit) if frame.maps else None
    return motion, integers


def frame_parameters(container: Container, frame: Frame) -> Parameters:
    """Return the parameters of a frame, those of frame 0 with its own steps."""
    return at_step(container.parameters, frame.step, frame.coarse, frame.finer)
