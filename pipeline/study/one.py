"""One run of a study: what a worker does."""

# SPDX-License-Identifier: GPL-3.0-or-later

import dataclasses
import shutil

from pipeline.analytics.models.prediction import filter_of_mat, predict
from pipeline.errors import CaseError
from pipeline.line import places, store
from pipeline.line.manifest import write_manifest
from pipeline.line.places import MANIFEST
from pipeline.line.run import Run, run
from pipeline.nouns.fibers import Mat
from pipeline.report.stage import REPORT
from pipeline.study.plan import WORK, Task
from pipeline.study.quantity import NO_ANSWER, PREDICTED, Results, stage_results

RESULT = "result.json"


def carry_out(task: Task) -> Results:
    """Run a task, keep its numbers on disk, and give them.

    A run that was killed continues with its first unfinished stage.

    Raises
    ------
    FibertwinError
        If a stage cannot do what the case asks.
    """
    # a page would be thrown away with the stages
    unread = frozenset() if task.keep or task.until == REPORT.name else frozenset({REPORT.name})
    outcomes = run(task.case, places.own_folder(task.folder, WORK, task.name), task.until, without=unread)
    # a stage that was skipped has nothing to tell
    finished = [outcome for outcome in outcomes if (outcome.folder / MANIFEST).exists()]
    results: Results = {outcome.stage: stage_results(outcome.folder) for outcome in finished}
    results[PREDICTED] = _predicted(task)
    with places.side_folder(task.result) as side:
        store.write_json(side / RESULT, results)
        write_manifest(side, {"key": task.key, "set": task.overrides, "until": task.until})
    if not task.keep:
        shutil.rmtree(task.work, ignore_errors=True)
    return read_result(task)


def read_result(task: Task) -> Results:
    """Read the numbers of a finished task."""
    results: Results = store.read_json(task.result / RESULT)
    return results


def _predicted(task: Task) -> Results:
    flow = task.case.flow
    try:
        return dataclasses.asdict(predict(filter_of_mat(Run(task.case, task.work).read(Mat), flow.flow()), flow))
    except CaseError as problem:
        # no model holds for such a mat, but its other numbers stand
        return {NO_ANSWER: str(problem)}
