import pytest

from labeler.evaluation.categories import CLASSES, DONT_CARE, NOT_COUNTED, class_of_category, class_of_labels


@pytest.mark.parametrize(
    ("category", "expected"),
    [
        ("CAR", "car"),  # our own drives
        ("BUS_RV_CARAVAN", "bus"),
        ("REGULAR_VEHICLE", "car"),  # Argoverse 2
        ("LARGE_VEHICLE", "truck"),
        ("BOX_TRUCK", "truck"),
        ("ARTICULATED_BUS", "bus"),
        ("MOTORCYCLE", "motorcycle"),
        ("RAILED_VEHICLE", "train"),
        ("vehicle.car", "car"),  # nuScenes
        ("vehicle.bus.rigid", "bus"),
        ("vehicle.emergency.police", "car"),
        ("Van", "car"),  # KITTI
        ("Tram", "train"),
        ("van", "car"),  # simulated
        ("pickup", "truck"),
        ("truck", "truck"),
    ],
)
def test_vehicles(category: str, expected: str):
    assert CLASSES[class_of_category(category)] == expected


@pytest.mark.parametrize(
    "category",
    [
        "DontCare",  # KITTI's unlabelled regions
        "Misc",
        "VEHICULAR_TRAILER",  # no label has that class, so a label on it is neither right nor wrong
        "vehicle.construction",
        "hovercraft",  # a vehicle that nobody thought of
    ],
)
def test_neither_hit_nor_miss(category: str):
    assert class_of_category(category) == DONT_CARE


@pytest.mark.parametrize(
    "category", ["PEDESTRIAN", "BICYCLE", "MOTORCYCLIST", "Cyclist", "movable_object.trafficcone", "Person_sitting"]
)
def test_not_counted(category: str):
    assert class_of_category(category) == NOT_COUNTED


def test_labels_of_other_classes_are_not_counted():
    # "carrot" has "car" in it and is none; a trailer is a vehicle, but no class that is counted
    names = ["person", "car", "truck", "carrot", "motorcycle", "trailer"]
    assert class_of_labels(names).tolist() == [NOT_COUNTED, 0, 1, NOT_COUNTED, 3, NOT_COUNTED]
