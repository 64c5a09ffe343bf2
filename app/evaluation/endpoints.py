"""Evaluation: the labels of a drive against its truth."""

from typing import Annotated

from fastapi import APIRouter, Query

from app.db.session import ReadSession
from app.dependencies import AppSettings
from app.evaluation import service
from app.evaluation.schemas import ClassMode, Evaluation
from labeler.evaluation.types import EvaluationConfig

router = APIRouter(prefix="/api", tags=["evaluation"])


@router.get("/drives/{drive_id}/evaluation")
def get_evaluation(
    drive_id: int,
    session: ReadSession,
    settings: AppSettings,
    confidence: Annotated[float, Query(ge=0, le=1, description="Labels below it are not counted.")] = 0.8,
    max_distance_m: Annotated[float, Query(gt=0, description="Truth beyond it is neither hit nor miss.")] = 80.0,
    classes: Annotated[ClassMode, Query(description="Whether a label of another class may hit.")] = ClassMode.AWARE,
) -> Evaluation:
    """Compare the drive's labels with its truth; 409 before it is labelled, 404 where it comes without truth."""
    config = EvaluationConfig(confidence=confidence, max_distance_m=max_distance_m, classes=classes)
    return Evaluation.model_validate(service.evaluate_stored_drive(session, settings, drive_id, config=config))
