"""Coordinates of a frame of sites: in the plane, or latitude and longitude in decimal degrees."""

import base64
import math
import warnings
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import InputError
from ..number_arrays import Flags, Floats
from .travel import Travel

if TYPE_CHECKING:
    from .frame_columns import Columns

INHABITED = 66.0
"""Degrees of latitude, north or south, beyond which few vehicles drive."""

SQUARE = 1.15
"""Ratio of the spreads in degrees up to which sites may have been drawn from a square of them."""


def coordinates_of(table: "Columns") -> tuple[bool, Floats | None]:
    """A flag for geographic coordinates, and the coordinates of shape (sites, 2), longitude before latitude; None without any.

    Raises InputError for one column without the other, both kinds, and angles out of range.
    """
    refuse_alone(table.titles)
    if "lat" not in table:
        return False, np.column_stack([_column(table, "x"), _column(table, "y")]) if "x" in table else None
    if "x" in table:
        four = ", ".join(repr(table.titles[own]) for own in ("x", "y", "lat", "lon"))
        raise InputError("there are two kinds of coordinates", "contradiction", expected="x and y, or lat and lon", found=four)
    lat, lon = _column(table, "lat"), _column(table, "lon")
    for what, values, most in (("latitude", lat, 90.0), ("longitude", lon, 180.0)):
        bad = ~(np.abs(values) <= most)
        if bad.any():
            k = int(np.argmax(bad))
            swapped = (
                "; are lat and lon swapped?" if what == "latitude" and np.abs(lon).max() <= 90.0 and np.abs(lat).max() <= 180.0 else ""
            )
            found = f"{values[k]}{swapped}"
            message = f"{what} of site {table.ids[k]} is out of range"
            raise InputError(message, "out-of-range", expected=f"{-most:g} to {most:g} degrees", found=found)
    return True, np.column_stack([lon, lat])


def refuse_alone(titles: Mapping[str, Any]) -> None:
    """Raise InputError for a coordinate without the other one; ``titles`` maps waybound's titles to those of the frame."""
    for pair in (("x", "y"), ("lat", "lon")):
        if len(present := [titles[own] for own in pair if own in titles]) == 1:
            raise InputError("coordinates need two columns", "missing", expected=" and ".join(pair), found=f"{present[0]!r} alone")


def _column(table: "Columns", title: str) -> Floats:
    try:
        return np.array(table[title].to_numpy(dtype=np.float64, na_value=np.nan))
    except (TypeError, ValueError) as error:
        raise InputError(f"column {title} must hold numbers", found=str(error)) from None


def warn_of_swapped(xy: Floats) -> None:
    """Warn where (longitude, latitude) look like (latitude, longitude).

    That is the case where all latitudes are beyond any road and the longitudes are not; where most sites lie in the open sea, and all on
    land or by a coast with the two columns exchanged; or where the sites, which seen from above would lie as widely from west to east as
    from south to north, do so only exchanged.
    """
    lon, lat = xy.T
    if (np.abs(lat) > INHABITED).all() and (np.abs(lon) <= INHABITED).all():
        why = "all latitudes are polar"
    elif _on_land_exchanged(xy):
        why = f"most sites lie in the open sea ({middle(xy)}), and all on land with the columns exchanged ({middle(xy[:, ::-1])})"
    elif _rounder_exchanged(lon, lat):
        why = "the sites would lie as widely from west to east as from south to north with the columns exchanged, and do not now"
    else:
        return
    warnings.warn(f"latitude and longitude may be swapped: {why}; check the columns lat and lon", UserWarning, stacklevel=5)


@dataclass(frozen=True)
class Middle:
    """Direction of the mean of some sites, as seen from the centre of the globe, in degrees, and the distance in km ``within`` which all of
    them lie."""

    latitude: float
    longitude: float
    within: float

    def __str__(self) -> str:
        north, east = "N" if self.latitude >= 0 else "S", "E" if self.longitude >= 0 else "W"
        return f"around {abs(self.latitude):.1f} {north}, {abs(self.longitude):.1f} {east}"


def middle(xy: Floats) -> Middle:
    """The middle of sites at (longitude, latitude), also across the date line."""
    lon, lat = np.radians(xy).T
    points = np.column_stack([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)])
    x, y, z = points.mean(axis=0).tolist()
    centre = math.degrees(math.atan2(y, x)), math.degrees(math.atan2(z, math.hypot(x, y)))
    around = Travel("haversine", coordinates=np.vstack([centre, xy]))
    return Middle(centre[1], centre[0], float(around.distance(0, np.arange(1, len(xy) + 1)).max()))


def _on_land_exchanged(xy: Floats) -> bool:
    if np.abs(xy[:, 0]).max() > 90.0:
        return False
    return bool(at_open_sea(xy).mean() > 0.5 and not at_open_sea(xy[:, ::-1]).any())


def _rounder_exchanged(lon: Floats, lat: Floats) -> bool:
    if len(lon) < 8 or np.abs(lon).max() > 89.0 or min(np.ptp(lon), np.ptp(lat)) <= 0.0 or max(np.ptp(lon), np.ptp(lat)) > 20.0:
        return False
    spread = float(np.std(lat) / np.std(lon))
    present = abs(math.log(spread / math.cos(math.radians(float(lat.mean())))))
    exchanged = abs(math.log(1.0 / spread / math.cos(math.radians(float(lon.mean())))))
    # Degrees of longitude are the shorter ones: of a round place, those of latitude spread wider only where they are exchanged.
    return spread > SQUARE and present > math.log(1.3) and exchanged < math.log(1.15)


# -- the open sea, coarsely: enough to see that sites lie where no vehicle drives -----------------------------------------

CELL = 1
"""Degrees of a cell."""

_COASTS = (
    "c-rlmKa3n#8Nk2US$5X2zF8}lyoi-&3lt+7pOr{)6w9+A1&xc8RB#0a6*)j6mblzZ5)?<sBBF!pj3|((T&6(Im;zHoB7Kl{j0?NMbC_`Naxe4v-k+KGy*E2&UqP2"
    "AC7zr4?VIoa``#OXFUR^33V=w6>RH%Sh+5#N%crxkXh&||lydyv^)+m;YFVycGtcGKED-C35MOAxl;Vp8gjx~SVRt3GBJh(&@*i}jPU;Mm+iPLi<&7%8YgA~5g6c"
    "%W1>TrnlX~FgX{AG0{>{RfR_uN|vw0sxse%*nh`2-C6;hL|ft7M;E}tlP-x@y<pB>;`Z4;}|F8oZXam2q~QAdjd@exWWrLNm47#tbP2TGAg5EcsF7a6`UR`5*9n<"
    "E@ruO5|>l#Iamk(1^c-jqMb7iaHUSkzw&jn(8psf*ZnTgsDfkcri(B76N<RAFN|{CEGc@CW(z15t-2oC6yvbUd_|WhUV==0Jq&8#mO<Ir>fcV$}iSbAo8d0(7H<q"
    "ctdcYoEX=0~9%`lrh%97uw50Mn@)XF#(;89oU)<-@grMp<$kN*(!`}=0)N*Boc=0HPh~45+MAkffI2ZLYWq$at)mPQ^q~hQ7qt`Fu4>LnefCYXBkejMCG;aW!yw("
    "QYJo}gADUUx@GDMOPaWki}-Vwt*5$v@Vv3eO6RJaIj%eyf_e*m#k6ycb#(exv9I2(puP-n1t_em&s(f(W6ZHUsZ2mpIOAOyN;uF@_gwfFVl5omsz~6l3*QcNzc$y"
    "q>d#R(Fg_g6x}jet`euGKA{D6(J@?OcY>&I}9;uU#Q?{>n;oK_h6as#~?7%gF@6qX51|9e(dBd(S%c+^`4$Rxd=pq&d8Xxz02X20zh|_L4s)J8Da8t39!<()#cu;"
    "g;b>~!$V%&5K2MbDnwbF2aFrPSa$5~i(U~P*9BvtA}bS+{EXD<9$+@@BpcUHN#a<~4IIe9A~mSa24Dw_zprXdUy3TMvxolrARRZSqF$1fgIIMQh{Rex-vQ2TUQ<M"
    "CamHK9I{8aN*0F?8U@@Z;2v<_M^QL%j8*nR(#Hem&F=wpy4iw!zKyqZZ!qyORojZmv6JgU{iXdSwfgkWtgf(TKw?qg&<38$*|nIxsFlA2rL^+pu)KQo@^s*ADW=)"
    "^}m4bR6mzj1WF5sqf`5Ui?Qp=gd^B^7nP+!zOfZS^-RumS2buy)r3u=++Zk=S=$V@5Ge@uQ0MwEPrC_Js2Ba=i=Fvu~&pAhU}S2QCC<LhoG&eX1<mP7Ma44G>wgf"
    "^Q<m66zl{kdv~lNdNXM|3cQPwKnpM0xWhuHitvlA7`QS>v449WVB|)}D_9AX^XI9psS$^l#3$eP#ZWD+>Of~{yHY~P;Jets<r1DaftMRICU!MK_@RQw{tlr?29D{"
    "9Qo{E{krbUyKFYIC9T<Iks)BpzUlcs}VM`9AD^2By?P_$of*a{Osfw^~yBi<_M^-^#aO2K*-Y5sZ1o)}n_~&#PM0m*I-ml?7DZTNW181h_hIVr^p2KT7JS-Pyri)"
    "YFM$D|;7M{%E)iQXDGcSJ>$R?>Pv}qymm%}m4tB~Uhhp$Z#o;t7+`s!9@VD#Gg{Tu9(ygfGm>2aZ1DU9_h1t$j|6kAOp7&xW0Al0DMuvnGfQ#Y3u4%F_zB=|YA9%"
    "1}MhvHva@4`w9Wn$qAW+A|tBP@A$G)xp!uvvC58VAamS++_TUVL*w%v_SaQfya^u$J8+_LXp%R_WBXRFQp2pi15YCd*M_y`n;sZ#E`xmKcOn!LH)fS8@xdZkJRU_"
    ")54JVPEz-ExPW?so>XDAx!_2{pO)Kn!2f#+SOjeg_=7OcmDVX@ubih8#t|Cq0(N#@2klo@kVw*VB<QH<s-;l*u*wn7NY}J%SoRf1~edy%o2W~p%1ap^DEN;2Aj%{"
    "7H+eKozWT%ao1T~;v;m+J8s4{ena^1Y@7Na+uoQh{IqIeygK|?FV6A_!v%FbJd@|{0?u2Qoo}DKDdA1nDk1py@+mNG{B~p<{R-gK&uCl4Re6%XW4pF?^Bog(yBTe"
    "(EPPl8RvEs8S%g-L(j^Hy-b(a@6V2<FVI2Q;F;-hkFN!66my=9JBTb@@7bAGCATVpi2i~Nd+U#E%Mb~6_P`Da2;s@+3u~HHI2gB~G5X>kH7M?mqL}kvbO>hEZq@7"
    "~mz%MJ$=aXfpBq1D7y~!ch8LIVq*!J;uX4b+rR5XLQw_MH0ky=U)rkt6lO&1oEw!aUi2W!W`V_0}_*<My|Qb>5|!Pc3j4|l~_2kWGmc46E07X)Uab80t_Y1>Z|IZ"
    "wOCl!-mc3W<#20Vuctzad>WO8sQpJ7?@W6Fn{A>+9fv+-j=?!dE@GBSzx~sjmmuy+^FyK%4HkFn4whj_$eaYMkzb_aENMvpyGQy>Nt0UpaH&{?p`0_I)mV>|t`^?"
    "QC3l;2jNnu;cw@=pN!;J$7bqTz(o%U$yYyyc=)5I&@(=Jim(YIH7$pLcgmX_FPM+pcv2h!v2XoQ$gT{e~%Op7bpHik)H%!{@>td7d$$_tUo>h8&xNP`3c~pJOP}!"
    "J47W^&gN@b?-PzXX_wtiB)78z|65e$pQaSCaL>@J=jK$u4YgmehbX>dS2a07P;>rWc!#kBHZpIt#~~}{(ADur|4FBFfTh;o4R7=4pZT=p7HRm`e-UV!IQa$XqJ2}"
    "g9xl9x{1~=&PlEK1;~w?uZ@H}eg3<pa<<AH|ARl6K$lmUSrJczqi&)n4Ogx*+|HbPM`X=VS3o79KUwwS%^7NQbM6BPe>uB6?iZ4eq{s$jyUzG"
)
"""Cells from the north pole and 180 degrees west on, row by row: whether there is any land in them. From the elevations of GLOBE (NOAA,
public domain) as the package global-land-mask 1.0.0 has them; islands below its kilometre are missing."""


def at_open_sea(xy: Floats) -> Flags:
    """True for places, longitude and latitude in degrees of shape (places, 2), in a cell without any land."""
    land = _land()
    rows = np.clip(((90.0 - xy[:, 1]) // CELL).astype(np.int64), 0, land.shape[0] - 1)
    columns = ((xy[:, 0] + 180.0) // CELL).astype(np.int64) % land.shape[1]
    sea: Flags = ~land[rows, columns]
    return sea


@cache
def _land() -> Flags:
    bits = np.frombuffer(zlib.decompress(base64.b85decode(_COASTS)), dtype=np.uint8)
    return np.unpackbits(bits).astype(bool).reshape(180 // CELL, 360 // CELL)
