"""Names that other toolkits give to columns of sites, vehicles, windows, shipments, groups and moves. To drop one would change the problem.

Source: the fields of PyVRP 0.14 (``Client, Depot, VehicleType``), VROOM 1.14 (API, and pyvroom), OR-Tools (data of the routing guides),
VRPSolverEasy 0.1, vrplib and VRPLIB's sections, Timefold, ArcGIS, vrpy, jsprit and GraphHopper, and the titles of the tables of Solomon,
Cordeau, and Li and Lim. Left out are words that more often stand for something else: jsprit's ``size``, vrpy's ``lower`` and ``upper``.
"""

import re
from collections.abc import Collection, Iterator, Mapping
from functools import cache

from ..suggestions import did_you_mean


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


OURS: dict[str, dict[str, str]] = {
    "sites": {
        "x": "x_coord coord_x x_coordinate pos_x easting",
        "y": "y_coord coord_y y_coordinate pos_y northing",
        "lat": "latitude gps_lat",
        "lon": "longitude lng long gps_lon gps_lng",
        "demand": "demands delivery deliveries linehaul drop_size quantity quantities qty amount load loads load_demand weight volume mass "
        "units pallets parcels packages boxes vol kg delivery_demand delivery_quantity delivery_quantities delivery_amount delivery_load "
        "delivery_weight",
        "pickup": "pickups backhaul backhauls collection collected collect pickup_demand pickup_quantity pickup_quantities pickup_amount "
        "pickup_load pickup_weight",
        "ready": "ready_time ready_date earliest earliest_time early earliest_start earliest_arrival start start_time begin begin_time "
        "tw_early tw_start tw_begin tw_open tw_min tw_from tw_lower window_start window_open window_begin time_window_start "
        "time_window_open time_window_begin time_window_early time_window_from open opens opening open_time opening_time not_before "
        "arrive_after beginning_of_time_window start_window window_from from_time time_from min_start_time min_start available_from "
        "slot_start",
        "due": "due_date due_time latest latest_time late latest_start latest_arrival end end_time deadline tw_late tw_end tw_close tw_max "
        "tw_to tw_upper window_end window_close time_window_end time_window_close time_window_late time_window_to close closes closing "
        "close_time closing_time not_after arrive_before end_of_time_window end_window window_to to_time time_to max_end_time max_end "
        "available_until available_to slot_end",
        "service": "service_time service_duration service_durations stand_time dwell dwell_time stop_time stop_duration stay stay_time "
        "handling_time unload_time unloading_time visit_time visit_duration duration",
        "reward": "prize profit score revenue gain bonus utility",
        "required": "mandatory compulsory must_visit obligatory is_required",
        "penalty": "penalties penalty_cost penalty_or_cost drop_penalty skip_penalty missed_cost disjunction_penalty",
        "depot": "is_depot depots",
        "skills": "skill required_skill required_skills needed_skills skill_set",
    },
    "fleet": {
        "name": "vehicle_name vehicle_id",
        "count": "num_available available num_vehicles number_of_vehicles max_number number quantity vehicles fleet_size num amount",
        "capacity": "capacities vehicle_capacity vehicle_capacities load_limit load_limits max_load",
        "start": "start_depot start_index starts start_point_id start_location start_site start_node depot depots home origin",
        "end": "end_depot end_index ends end_point_id end_location end_site end_node destination",
        "max_duration": "shift_duration duration duration_limit route_duration_limit max_time max_route_duration max_working_time tmax",
        "max_distance": "distance max_route_distance distance_limit route_distance_limit range max_length",
        "energy": "battery battery_capacity fuel fuel_capacity tank max_travel_time",
        "fixed_cost": "fixed cost_fixed cost_per_vehicle",
        "unit_cost": "unit_distance_cost per_km cost_per_km cost_per_kilometer cost_per_kilometre cost_per_distance distance_cost "
        "var_cost_dist variable_cost variable_costs",
        "unit_duration_cost": "unit_time_cost per_hour cost_per_hour cost_per_time time_cost duration_cost var_cost_time",
        "unit_overtime_cost": "overtime_cost per_overtime_hour",
        "shift_start": "tw_early tw_start tw_begin earliest earliest_start ready ready_time start_time start_early time_window_start "
        "window_start opens open",
        "shift_end": "tw_late tw_end tw_close latest latest_end due due_date due_time end_time end_late time_window_end window_end "
        "closes close",
        "shift": "time_window time_windows working_time working_hours",
        "skills": "skill skill_set capabilities",
        "speed": "speed_factor speed_kmh velocity",
        "travel": "profile routing_profile matrix",
        "reloads": "reload_depots reload_depot reload_sites",
        "max_reloads": "max_trips trips",
    },
    "windows": {
        "site": "id site_id customer client node job stop location name",
        "ready": "ready_time earliest early tw_early tw_start tw_begin start start_time begin open opens from window_start",
        "due": "due_date due_time latest late tw_late tw_end end end_time close closes to deadline window_end",
    },
    "shipments": {
        "pickup": "pickup_id pickup_site pickup_location pickup_index from origin source",
        "delivery": "delivery_id delivery_site delivery_location delivery_index dropoff to destination target",
        "load": "amount demand quantity weight volume size",
    },
    "groups": {
        "group": "group_id name alternative alternatives",
        "site": "id site_id customer client node job stop location",
        "required": "mandatory compulsory",
    },
    "moves": {
        "from": "from_id from_site from_node origin origin_id source source_id start start_id tail u i from_index orig o",
        "to": "to_id to_site to_node destination destination_id target target_id end end_id head v j to_index dest d",
        "distance": "distances dist length len km kms kilometers kilometres miles meters metres weight travel_distance road_distance "
        "driving_distance distance_meters",
        "duration": "durations time times travel_time travel_duration drive_time driving_time trip_time transit_time journey_time hours h "
        "minutes mins min seconds secs sec tt duration_seconds static_duration",
    },
}  # fmt: skip
"""Names in other toolkits, by table and by our title."""

_WAITING = "waybound has no release times: goods are at the depot when it opens"
_ORDER = "a site before another one is an entry of shipments"
_PAIRS = "pairs of a pickup and a delivery are given by shipments"
_GROUPS = "alternatives are given by groups"
_WINDOWS = "both ends of a window are the columns ready and due, several windows of a site are given by windows"
_FIXED = "waybound fixes no part of a route; skills tie a site to a vehicle"
_ONLY = "which vehicles may come is told by skills, of sites and of vehicles"

ELSEWHERE: dict[str, dict[str, str]] = {
    "sites": {
        _WAITING: "release release_time release_date",
        _WINDOWS: "time_window time_windows tw windows window opening_hours business_hours",
        _PAIRS: "pickups_deliveries pickup_delivery pickup_index delivery_index pickup_id delivery_id partner sibling pair shipment "
        "shipment_id",
        _GROUPS: "group group_id id_customer mutually_exclusive alternatives disjunction disjunctions",
        "waybound has no priorities: what a visit is worth is the column reward, what leaving it out costs is penalty": "priority "
        "importance",
        "a load to bring is the column demand, one to take along is pickup, and the time it takes is service": "unloading loading",
        "it is the column required, the other way round": "optional is_optional droppable allow_drop can_skip skippable",
        "waybound has no set-up times apart from service": "setup setup_time default_setup setup_per_type setup_duration "
        "preparation_time preparation",
        "waybound has one service time for all vehicles": "service_per_type default_service",
        _FIXED: "locked lock fixed pinned frozen assigned_to assigned_vehicle fixed_vehicle steps sequence_number visit_order",
        _ONLY: "incompatible_vehicles allowed_vehicles forbidden_vehicles disallowed_vehicles vehicles_allowed "
        "allowed_vehicle_indices vehicle vehicle_id vehicle_type",
        _ORDER: "predecessor predecessors successor successors precedence precedences",
        "waybound visits a site once": "frequency frequency_of_visit visit_frequency combinations",
        "waybound has no such rules of sites on one route": "incompatible incompatibilities conflicts same_vehicle same_route",
        "vehicles are told by the arguments vehicles, capacity, max_duration, ... or by fleet": "capacity capacities vehicle_capacity "
        "vehicle_capacities num_vehicles vehicles num_available max_duration max_distance shift_duration fixed_cost speed_factor "
        "max_number start_depot end_depot reload_depots max_tasks start_late",
        "the column depot tells which sites are depots": "starts ends",
        "coordinates are the columns x and y, or lat and lon": "coordinates coords coordinate location_index locations geometry point",
    },
    "fleet": {
        "waybound has no breaks": "breaks break lunch lunch_break",
        "waybound limits no number of stops; a load dimension with a demand of 1 each does": "max_tasks max_stops max_visits max_customers "
        "max_order_count max_orders",
        "waybound has no latest departure beside the shift": "start_late latest_departure latest_start latest_start_time",
        "vehicles of waybound start with the load of their deliveries": "initial_load initial_loads",
        "max_duration is the longest time with overtime, regular_duration the one without": "max_overtime overtime",
        "costs are fixed_cost, unit_cost (of a distance) and unit_duration_cost": "cost costs per_task_hour",
        "waybound fixes no part of a route": "steps locked",
        "types of vehicles are the rows of the fleet; which sites they may serve is told by skills": "type vehicle_type",
        "loading and unloading are the service of sites": "vehicle_load_time vehicle_unload_time",
    },
    "windows": {},
    "shipments": {
        "what else is asked of a pair is asked of its two sites, in their columns": "skills priority prize required tw_early tw_late "
        "time_window time_windows pickup_tw_early pickup_tw_late pickup_service_duration delivery_tw_early "
        "delivery_tw_late delivery_service_duration",
    },
    "groups": {},
    "moves": {
        "costs come of distances (unit_cost) and durations (unit_duration_cost)": "cost costs price toll",
        "variances are the argument variances, a matrix": "variance variances var std sigma standard_deviation",
        "latest times of moves are the argument closing, a matrix": "closing closes",
        "waybound takes durations, no speeds of moves": "speed maxspeed velocity",
        "moves between two sites go one way: one row for each way": "oneway directed bidirectional",
        "a move that cannot be made has no row": "forbidden allowed closed blocked",
    },
}
"""Names for which we have no column, by table and by what the error says."""

UNITS = _words(
    "s sec secs second seconds min mins minute minutes h hr hrs hour hours d day days kg kgs g t ton tons tonne tonnes lb lbs "
    "l litre litres m3 km kms m mi mile miles meter meters metre metres eur euro euros usd gbp unix iso utc section"
)
"""Last words that say in what a column is measured."""

OWNERS = _words("site sites customer customers client clients node nodes job jobs task tasks stop stops visit order location")
"""First words that say whose quantity it is; those of a fleet are below."""
VEHICLES = _words("vehicle vehicles truck van route")

MORE_LOADS = _words("quantity quantities qty amount load loads weight volume mass units pallets parcels packages boxes vol kg")
"""Names of loads that may well stand beside another load."""

PLACES = ("x", "y", "lat", "lon")
"""Titles behind which a number tells another place."""

_CAMEL = re.compile(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")


def ours(title: str, table: str = "sites") -> str | None:
    """Waybound's title of what others call ``title``, in any case, spacing and unit, or None; titles of further loads keep their number."""
    known = _squashed(table)
    for name, number in _variants(title, table):
        if name in known and not (number and known[name] in PLACES):
            own = known[name]
            return f"{own}{number}" if own in ("demand", "pickup", "capacity", "load") and number in "23456789" else own
    return None


def elsewhere(title: str, table: str = "sites") -> str | None:
    """The reason why a name that stands for something has no column in ``table``, and what to do; None for any other name."""
    known = _told(table)
    return next((known[name] for name, _ in _variants(title, table) if name in known), None)


def hint(title: str, table: str, known: Collection[str]) -> str:
    """End of a message on an unknown title: its name here, what to do instead, or the title that it is likely misspelt for."""
    own, reason = ours(title, table), elsewhere(title, table)
    if own is not None:
        return f"; did you mean {own!r}?"
    return f"; {reason}" if reason is not None else did_you_mean(title, known)


def may_be_another_load(title: str) -> bool:
    """True if a name of loads may mean another load than the one that is there."""
    return any(name in MORE_LOADS for name, _ in _variants(title, "sites"))


def _variants(title: str, table: str) -> Iterator[tuple[str, str]]:
    """The title in one word, then without units, owner and number, each with the number at its end."""
    words = [word for word in re.split(r"[^a-z0-9]+", _CAMEL.sub("_", title).casefold()) if word]
    owners = VEHICLES if table == "fleet" else OWNERS
    seen = set()
    while words:
        for some in (words, words[1:] if words[0] in owners else words):
            whole = "".join(some)
            bare = whole.rstrip("0123456789")
            for name, number in ((whole, ""), (bare, whole[len(bare) :])):
                for each in (name, name.removesuffix("s")):
                    if each and each not in seen:
                        seen.add(each)
                        yield each, number
        if words[-1] not in UNITS:
            return
        words = words[:-1]


@cache
def _squashed(table: str) -> Mapping[str, str]:
    return {name.replace("_", ""): own for own, names in OURS[table].items() for name in (own, *names.split())}


@cache
def _told(table: str) -> Mapping[str, str]:
    return {name.replace("_", ""): reason for reason, names in ELSEWHERE[table].items() for name in names.split()}
