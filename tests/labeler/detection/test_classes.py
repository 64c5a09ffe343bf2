from labeler.detection.classes import COCO_CLASSES, ROAD_USER_CLASSES, VEHICLE_CLASSES, suppression_group_of


def test_coco_has_80_classes_at_the_places_that_the_official_weights_use() -> None:
    assert len(set(COCO_CLASSES)) == 80
    assert [COCO_CLASSES.index(name) for name in ROAD_USER_CLASSES] == [0, 1, 2, 3, 5, 6, 7]
    assert COCO_CLASSES[79] == "toothbrush"


def test_four_wheelers_share_a_group_and_two_wheelers_another() -> None:
    groups = dict(zip(ROAD_USER_CLASSES, suppression_group_of(ROAD_USER_CLASSES).tolist(), strict=True))
    assert len({groups[name] for name in VEHICLE_CLASSES}) == 1
    assert groups["bicycle"] == groups["motorcycle"]
    assert len({groups["person"], groups["bicycle"], groups["car"]}) == 3


def test_names_that_belong_nowhere_stand_alone_whatever_their_case() -> None:
    first, car, second, truck = suppression_group_of(("cone", "Car", "animal", "TRUCK"))
    assert car == truck
    assert len({int(first), int(second), int(car)}) == 3
