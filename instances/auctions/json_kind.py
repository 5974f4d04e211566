"""Kinds of instances of auctions and task allocation in waybound's JSON; the keys are documented in ``docs/formats.md``."""

from ..kinds import KINDS, kind_of
from .assignment import AssignmentInstance
from .exploration_map import ExplorationMap
from .generalised_assignment import GeneralisedAssignmentInstance
from .joint_assignment import JointAssignmentInstance
from .orchard_jobs import OrchardJobs
from .robot_tasks import RobotTasks

for model in (AssignmentInstance, ExplorationMap, GeneralisedAssignmentInstance, JointAssignmentInstance, OrchardJobs, RobotTasks):
    KINDS.add(model.kind, kind_of(model))
