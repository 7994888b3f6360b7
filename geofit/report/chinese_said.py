"""What fits, checks and examinations say, in Chinese, by the English templates of :func:`geofit.data.messages.said`."""

from __future__ import annotations

__all__ = ["SAID"]

_FIT = {
    "height field over its best plane: it dips {dip:.0f} degrees": "取最佳平面上的高度场：倾角 {dip:.0f}°",
    "height field over the map; some section lines run backwards, look at the residuals there": "取平面上的高度场；部分剖面线有"
    "倒转，请查看该处残差",
    "height field over the map (mean dip {dip:.0f} degrees)": "取平面上的高度场（平均倾角 {dip:.0f}°）",
    "{lines} section lines found in the points' plan": "由点的平面分布识别出 {lines} 条剖面线",
    "frame '{frame}' as asked": "按要求采用坐标架“{frame}”",
    "parametric surface through its sections: {share:.0f} % of their length runs backwards (overturned), so it is no "
    "height field": "取通过各剖面线的参数曲面：剖面线有 {share:.0f} % 的长度倒转，不能作高度场",
    "points beyond the study area: {count}; the surface is widened to hold them": "{count} 个点位于研究区之外，曲面已外扩将其包含",
    "core points on the surface: {count}": "核心区 {count} 个点位于曲面上",
    "{count} of {total} approximated points beyond the interior tolerance": "{total} 个逼近点中有 {count} 个超过内部容差",
    "{count} of {total} points beyond the interior tolerance": "{total} 个点中有 {count} 个超过内部容差",
    "largest gap of the seams ({count})": "{count} 条拼接缝的最大缝隙",
    "largest angle at a seam": "拼接缝处的最大夹角",
    "largest angle at a seam (breaks are allowed)": "拼接缝处的最大夹角（允许折线）",
    "{dropped} repeats {kept}": "{dropped} 与 {kept} 重复",
    "{dropped} differs by {difference:+.3f} m from {kept} at one place; kept: {reason}": "{dropped} 与 {kept} 位置相同而高程相差 "
    "{difference:+.3f} m；取舍依据：{reason}",
    "the better stated accuracy": "注明精度较高者",
    "the source nearer to the rock": "资料来源更直接者",
    "the first": "先读入者",
    "across='linear' needs at least two straight, named sections; the core is cubic across": "across='linear' 至少需要两条有名称的"
    "直剖面；核心区在剖面间按三次插值",
    "a core linear across its sections cannot meet all of its points; it is cubic across": "剖面间线性的核心区不能通过其全部点，"
    "改用三次插值",
    "{n} points are judged by sigma, not pulled into the tolerance one by one; noise about {noise:.3f} m": "{n} 个点以 σ 评判，"
    "不逐点拉入容差；噪声约 {noise:.3f} m",
    "no more control points are allowed there": "该处不允许再增加控制点",
    "interior tolerance {tolerance:g} m not met in height, points: {count}, worst {worst:.3f} m: {reason}": "{count} 个点未满足内部容差 "
    "{tolerance:g} m，最大 {worst:.3f} m：{reason}",
    "the points scatter by about {noise:.2g} m about the smoothest surface that they support; meeting each within {tolerance:g} m bends it between them, and an interior tolerance of about {wider:.2g} m would predict new holes better": "各点围绕其所能支持的最光滑曲面的离散约为 {noise:.2g} m；要求逐点在 {tolerance:g} m 以内会使曲面在点间弯曲，内部容差取约 {wider:.2g} m 时对新钻孔的预测更好",
    "its points bear each other out to about {noise:.3g} m only, more than epsilon {epsilon:g} m": "其各点仅能在约 {noise:.3g} m 内相互印证，超过控制误差 ε {epsilon:g} m",
    "the data contradict each other by about {noise:.2f} m, which is not chased": "数据相互矛盾约 {noise:.2f} m，不予追合",
    "the smoothing is given": "光滑系数为给定值",
    "{n} dense points would need more control points than data to be interpolated; all points are approximated (name a "
    "smaller core to interpolate it)": "插值 {n} 个密集点所需控制点多于数据点，全部点改为逼近（可指定较小的核心区进行插值）",
    "{reason}: {within} points inside, {outside} outside": "{reason}：区内 {within} 点，区外 {outside} 点",
    "{n} points are too few to tell a dense core from a periphery (40 are needed)": "仅 {n} 个点，不足以区分密集核心区与外围区"
    "（至少 40 个）",
    "the densest part is only {contrast:.1f} times as dense as the rest": "最密部分的密度仅为其余部分的 {contrast:.1f} 倍",
    "{count} points with a spacing below {limit:.0f} m fill {width:.0f} m x {length:.0f} m, {contrast:.1f} times as dense "
    "as the other {others} points": "{count} 个点间距小于 {limit:.0f} m，分布于 {width:.0f} m × {length:.0f} m，密度为其余 {others} "
    "个点的 {contrast:.1f} 倍",
    "no dense core: {reason}; all points are approximated": "无密集核心区：{reason}；全部点采用逼近",
    "{reason}; no point lies inside, so all are approximated": "{reason}；区内无点，全部点采用逼近",
    "{reason}; no point lies outside, so all are interpolated": "{reason}；区外无点，全部点采用插值",
    "the points are spread evenly": "点分布均匀",
    "the dense places hold fewer than 20 points each": "各密集处均不足 20 个点",
    "the {count} dense points lie along a line {length:.0f} m long and {width:.0f} m wide: one section makes no core, all "
    "points are approximated": "{count} 个密集点沿一条长 {length:.0f} m、宽 {width:.0f} m 的线分布：单一剖面不构成核心区，"
    "全部点采用逼近",
    "the dense points fill the area": "密集点布满全区",
    "{reason}, but all points are approximated: {error}": "{reason}，但全部点采用逼近：{error}",
    "sigma stays above epsilon: no further local adjustment lowers it (made: {step})": "σ 仍大于 ε：经 {step} 次局部调整后"
    "已无法再降低",
    "local adjustments until sigma came below epsilon: {step}": "经 {step} 次局部调整，σ 降至 ε 以下",
    "the section curves span the whole surface": "剖面曲线张成整个曲面",
    "core='all': every point is interpolated": "core='all'：全部点采用插值",
    "core='none': every point is approximated": "core='none'：全部点采用逼近",
    "the core's polygon as drawn": "按所绘多边形取核心区",
    "meeting all {n} points would swing the surface by {swing:.3g} m": "若通过全部 {n} 个点，曲面将摆动 {swing:.3g} m",
    "not all {n} points can be met exactly ({left:.1e} m is left)": "{n} 个点不能全部精确通过（余 {left:.1e} m）",
    "the system of its {n} points is singular": "其 {n} 个点的方程组奇异",
    "The core cannot be interpolated: {what}. Points lie nearer to each other than the allowed control points. Raise "
    "max_control_points or conflict_distance, or approximate (core='none').": "核心区不能插值：{what}。点距小于允许的控制点间距。"
    "请增大 max_control_points 或 conflict_distance，或改用逼近（core='none'）。",
    "({x:.2f}, {y:.2f}, {z:.2f})": "（{x:.2f}，{y:.2f}，{z:.2f}）",
    "by hand: control point ({i}, {j}) of patch '{patch}' moved by {dz:+.3g} m": "人工调整：曲面片“{patch}”的控制点（{i}，{j}）"
    "移动 {dz:+.3g} m",
    "by hand: pulled by {share:.0%} of the distance to {name}": "人工调整：向 {name} 拉近其距离的 {share:.0%}",
    "by hand: control point ({i}, {j}) of patch '{patch}' has weight {weight:g}": "人工调整：曲面片“{patch}”的控制点（{i}，{j}）"
    "权重为 {weight:g}",
    "{upper} and {lower} cannot be pushed apart at ({x:.1f}, {y:.1f}), {lack:.3f} m are missing: {above} of {upper} stands "
    "against {below} of {lower}": "{upper} 与 {lower} 在（{x:.1f}，{y:.1f}）处不能分开，尚差 {lack:.3f} m：{upper} 的 {above} 与 "
    "{lower} 的 {below} 相互制约",
    "moved by up to {most:.3f} m to keep the order of strata": "为保持地层次序，最多移动 {most:.3f} m",
    "no exact point": "无精确点",
    "{lines} section curves over {length:.0f} m, {count} points between them": "{length:.0f} m 内有 {lines} 条剖面曲线，其间有 {count} "
    "个点",
    "robust: peripheral points that their neighbours do not bear out take no part in the fit ({count}: {names}); "
    "sigma counts them all the same": "稳健拟合：外围区有 {count} 个与相邻点不符的点未参与拟合（{names}），σ 仍计入这些点",
    "{count} points are too many for robust weights": "{count} 个点过多，不能采用稳健权",
    "{fault} throws {horizon} down by {low:.2f} to {high:.2f} m, {mean:.2f} m on average over {length:.0f} m: {up} lies above "
    "{down}": "{fault} 使 {horizon} 落差 {low:.2f} 至 {high:.2f} m，沿 {length:.0f} m 平均 {mean:.2f} m：{up} 高于 {down}",
    "all points of {horizon} lie on one side of {fault}": "{horizon} 的全部点位于 {fault} 一侧",
    "{block} rests on {count} points only": "{block} 仅有 {count} 个点",
    "excluded, and in no block: {points}": "已剔除且不属于任何断块的点：{points}",
    "the fault {fault} cannot be laid: {reason}": "断层 {fault} 不能成面：{reason}",
    "{names}: cut by a fault, so not pushed apart from other horizons": "{names}：被断层切割，未与其他层面分开",
    "no repair: the order of the site names no two fitted horizons without a fault": "未作修正：场地次序中没有两个已拟合且未被断层切割的"
    "层面",
    "no repair: {reason}": "未作修正：{reason}",
    "{name}: no 90 % surfaces, its standard deviation is not known": "{name}：标准差未知，未输出 90 % 上下界面",
    "The order of the horizons was not examined: {reason}": "未检验层面次序：{reason}",
}

_SETTINGS = {
    "Control error (epsilon)": "控制误差 ε（epsilon）",
    "Interior tolerance (interior_tolerance)": "内部容差（interior_tolerance）",
    "Seam tolerance (boundary_tolerance)": "拼接缝容差（boundary_tolerance）",
    "Across sections (across)": "剖面之间（across）",
    "At the seams (seam)": "拼接缝处（seam）",
    "Exact core (core)": "精确核心区（core）",
    "Laid over (frame)": "展布于（frame）",
    "Smoothing (smoothing)": "光滑系数（smoothing）",
    "Outliers (robust)": "异常点（robust）",
    "Rounds, at most (max_iterations)": "最多轮数（max_iterations）",
    "Control points (max_control_points)": "控制点（max_control_points）",
    "One place within (conflict_distance)": "视为同一位置（conflict_distance）",
    "metres": "米",
    "the auto value's unit, or the word 'auto'": "与自动值同单位，或写 'auto'",
    "{setting} is {value}; a finite number above 0 is needed ({unit}).": "{setting}为 {value}；应为大于 0 的有限数（{unit}）。",
    "{setting} is {value}; choose one of {words}.": "{setting}为 {value}；应取 {words} 之一。",
    "{setting} is {value}; choose one of {words} or a polygon of map coordinates.": "{setting}为 {value}；应取 {words} "
    "之一，或平面坐标多边形。",
    "{setting} is {value}; true or false is needed.": "{setting}为 {value}；应为 true 或 false。",
    "{setting} is {value}; a whole number >= 0 is needed.": "{setting}为 {value}；应为不小于 0 的整数。",
    "{setting} is {value}; a whole number of at least 16 is needed.": "{setting}为 {value}；应为不小于 16 的整数。",
    "{setting} has shape {shape}; a polygon of at least three (easting, northing) corners is needed.": "{setting}的形状为 "
    "{shape}；应为至少三个角点（东坐标，北坐标）的多边形。",
}

_ERRORS = {
    "{count} point given": "仅给出 {count} 个点",
    "{count} points given": "给出 {count} 个点",
    "{given}; at least 3 are needed to lay a surface. Check the horizon's name and the filters of the import.": "{given}；成面至少需 3 "
    "个点。请检查层面名称与导入筛选。",
    "The points look like longitude and latitude in degrees (the first: {x:.6g}, {y:.6g}); easting and northing in "
    "metres are needed. Project them to the grid of the site (geofit fit --crs EPSG:..., or crs in the site file).": "各点坐标似为以度为"
    "单位的经纬度（首点：{x:.6g}，{y:.6g}）；应为以米为单位的东坐标与北坐标。请投影到场地坐标系（命令行 --crs EPSG:...，或场地文件中的 crs）。",
    "{reason}; points that it does not meet, by up to {worst:.3g} m: {count}, which count as approximated": "{reason}；其中 {count} 个点"
    "未能通过（最大相差 {worst:.3g} m），按逼近点计",
    "The boundary is no list of corners; at least three pairs of easting and northing are needed.": "边界不是角点列表；至少需三对东、北坐标。",
    "{fault}. List the corners in order around the study area, each once.": "{fault}。请沿研究区依次列出各角点，每点一次。",
    "All points lie off the study area, the nearest by {off:.0f} m. Check the coordinates of both, and the order of "
    "easting and northing.": "全部点位于研究区之外，最近者相距 {off:.0f} m。请检查二者坐标及东、北坐标的次序。",
    "A coordinate is {farthest:.3g} m; at most {largest:.0e} m are fitted. Check the unit and the columns.": "有坐标为 {farthest:.3g} m；"
    "最多拟合 {largest:.0e} m。请检查单位与列。",
    "The boundary has no area: its corners lie on one line": "边界没有面积：各角点在一条直线上",
    "All {count} points stand at one place; at least 3 places are needed.": "全部 {count} 个点位于同一位置；至少需 3 个不同位置。",
    "The boundary has shape {shape}; at least three finite (easting, northing) corners are needed.": "边界的形状为 {shape}；至少需三个"
    "有限的角点（东坐标，北坐标）。",
    "core is a polygon of map coordinates, but the surface is fitted in the frame '{frame}'. Choose core='auto', 'all' or "
    "'none', or frame='map'.": "核心区为平面坐标多边形，而曲面采用坐标架“{frame}”。请取 core='auto'、'all' 或 'none'，或 frame='map'。",
    "The core's polygon lies outside the study area. Check its coordinates and their order.": "核心区多边形位于研究区之外。请检查其坐标"
    "与顺序。",
    "The order names '{name}', which has no surface; there are {names}. Fit it, or take it out of the order.": "次序中的“{name}”没有"
    "曲面；现有 {names}。请先拟合，或将其移出次序。",
    "The order names a horizon twice: {names}. Name each once, top to bottom.": "次序中有层面重复：{names}。请自上而下各写一次。",
    "'{name}' is no height field over the map, so nothing can be said to lie above or below it. Name fitted horizons only; "
    "leave out faults, overturned folds and triangles read from files.": "“{name}”不是平面上的高度场，不能判断上下关系。请只列拟合的"
    "层面，不含断层、倒转褶皱与文件读入的三角网。",
    "'{name}' has no control net over the map: it was read from a file, or is no height field. Fit it again, or take it out "
    "of the order.": "“{name}”没有平面上的控制网：由文件读入，或不是高度场。请重新拟合，或将其移出次序。",
    "The least thickness is {value}; give metres, 0 or more.": "最小厚度为 {value}；应不小于 0（m）。",
    "Too few points in the block '{block}' of {horizon}: {count} ({points}); at least {least} are needed to lay a surface. "
    "Give more points there, or leave the fault out.": "{horizon} 的断块“{block}”点数过少：{count} 个（{points}）；成面至少需 {least} 个。"
    "请补充该处数据，或不计该断层。",
    "The block '{block}' has points on a side of {fault} where its surface has no area. Look at the points beside the fault: "
    "one on the wrong side makes a block of its own.": "断块“{block}”在 {fault} 某一侧有点而无曲面范围。请查看断层旁的点：错位的点会"
    "自成一块。",
    "frame='sections' needs at least two named sections with ordered points; {lines} were given. Name them in the section "
    "column, or choose frame='map' or 'best-plane'.": "frame='sections' 至少需两条有名称且点序正确的剖面；现有 {lines} 条。请在剖面列"
    "中命名，或取 frame='map' 或 'best-plane'。",
    "No smoothing makes the system of {points} points and {size} control points solvable: the points lie on too few places. "
    "Give more points, or a larger conflict_distance.": "{points} 个点与 {size} 个控制点的方程组在任何光滑系数下均不可解：点位过少。"
    "请补充数据，或增大 conflict_distance。",
    "The core is straight between its section curves: its control points follow the sections.": "核心区在剖面曲线间为直线，其控制点随"
    "剖面而定。",
    "The core is straight between its section curves: pull at a point of the periphery.": "核心区在剖面曲线间为直线，请拉动外围区的点。",
    "Control points with weights other than 1 act here. Set their weights to 1 first.": "此处有权重不为 1 的控制点。请先将其权重设为 1。",
    "The weight is {weight:g}; between 0.01 and 100 is needed (1 is neutral).": "权重为 {weight:g}；应在 0.01 至 100 之间（1 为不加权）。",
    "Control point ({i}, {j}) of patch '{patch}' holds the tangent plane of a seam; its weight stays 1. Choose one at least "
    "{rows} rows away from the seam.": "曲面片“{patch}”的控制点（{i}，{j}）决定拼接缝处的切平面，权重保持 1。请选择距缝至少 {rows} 行的"
    "控制点。",
    "'{name}' was read from a file: its patches have no common control net. Fit it again, then adjust.": "“{name}”由文件读入，各曲面片"
    "没有公共控制网。请重新拟合后再调整。",
    "{name} is {value}; a finite number up to {most:.0e} is needed.": "{name} 为 {value}；应为不超过 {most:.0e} 的有限数。",
    "There is no patch '{patch}'. The patches are: {names}.": "没有曲面片“{patch}”。现有：{names}。",
    "The point {point} lies beside the surface '{name}'. Choose a place above or below it.": "点 {point} 在曲面“{name}”范围之外。请选择"
    "其上方或下方的位置。",
    "{first}, {second}": "{first}，{second}",
    "{place}: {sentence}": "{place}：{sentence}",
    "{reason}.": "{reason}。",
    "{reason}. {remedy}": "{reason}。{remedy}",
    "row {row}": "第 {row} 行",
    "column '{column}'": "列“{column}”",
    "value '{value}'": "值“{value}”",
}

_CHECKS = {
    "the horizon stays below the ground (within {tolerance:g} m)": "层面位于地面以下（允许 {tolerance:g} m）",
    "the horizon stands above the ground: by {value:.1f} m at {x:.0f}, {y:.0f}, where its own points hold it; {points} "
    "points and {area:.0f} square metres in all are more than {tolerance:g} m above it": "层面高出地面：在 {x:.0f}，{y:.0f} 处高出 "
    "{value:.1f} m，且有其自身数据点控制；共有 {points} 个点、{area:.0f} m² 高出地面 {tolerance:g} m 以上",
    "away from its points the horizon goes on above the ground, up to {value:.1f} m over {area:.0f} square metres: eroded "
    "there, or not held by any point": "远离数据点处层面高出地面，最多 {value:.1f} m，面积 {area:.0f} m²：已被剥蚀，或无点控制",
    "measured dips that contradict the surface: {count} of {n}, the worst is {azimuth:.0f}/{dip:.0f} where the "
    "surface dips {surface_azimuth:.0f}/{surface_dip:.0f} ({angle:.0f} degrees between the planes); the "
    "measurement belongs to another structure, or the surface is wrong there": "{n} 组实测产状中有 {count} 组与曲面不符：最差者为 {azimuth:.0f}°∠{dip:.0f}°，而曲面为 "
    "{surface_azimuth:.0f}°∠{surface_dip:.0f}°（两面夹角 {angle:.0f}°）；该测点属另一构造，或曲面在该处有误",
    "the measured dips ({n}) agree with the surface, the worst by {angle:.0f} degrees": "{n} 组实测产状与曲面相符，最大相差 {angle:.0f}°",
    "points beyond the surface's edge, measured to the edge: {count} of {total}": "{total} 个点中有 {count} 个位于曲面边界"
    "之外，量至边界",
    "{count} of {total} triangles turned over or without an area": "{total} 个三角形中有 {count} 个翻转或面积为零",
    "A triangle mesh: seams, control points and the tangent plane do not apply.": "三角网：不适用拼接缝、控制点与切平面检查。",
    "beyond the surface: {point}": "曲面以外：{point}",
    "beyond the surface: further points, {count}": "曲面以外：另有 {count} 个点",
    "elevations reach {value:.1f} m beyond the data's range": "高程超出数据范围 {value:.1f} m",
    "{upper} lies below {lower} (places: {count}): {area:.0f} m2, {volume:.0f} m3, deepest {depth:.2f} m at "
    "({x:.1f}, {y:.1f})": "{upper} 有 {count} 处低于 {lower}：面积 {area:.0f} m²，体积 {volume:.0f} m³，最深 {depth:.2f} m，位于（{x:.1f}，{y:.1f}）",
    "{upper} lies above {lower} everywhere: {low:.2f} to {high:.2f} m, {mean:.2f} m on average": "{upper} 处处高于 {lower}：厚度 "
    "{low:.2f} 至 {high:.2f} m，平均 {mean:.2f} m",
    "{upper} lies below {lower} above the ground only (places: {count}): {area:.0f} m2, {volume:.0f} m3": "{upper} 仅在地面以上低于 "
    "{lower}：{count} 处，面积 {area:.0f} m²，体积 {volume:.0f} m³",
    "{upper} and {lower} share no area": "{upper} 与 {lower} 无公共范围",
    "the surface swings between the points: at {x:.0f}, {y:.0f} by {value:.1f} m from what those around support ({limit:.1f} "
    "m allowed), and so at {count} of {n} places; a point there may be wrong, or the tolerance finer than the data": "曲面在点间摆动："
    "在 {x:.0f}，{y:.0f} 处偏离周围各点所支持的高程 {value:.1f} m（允许 {limit:.1f} m），{n} 处中有 {count} 处如此；该处可能有错误点，"
    "或容差小于数据精度",
    "between the points the surface keeps to what they support; it departs by {value:.1f} m where {limit:.1f} m are "
    "allowed, at {x:.0f}, {y:.0f}": "点间曲面与各点所支持者相符；在 {x:.0f}，{y:.0f} 处偏离 {value:.1f} m，允许 {limit:.1f} m",
    "not judged: no patch has {few} approximated points": "不予评判：无曲面片有 {few} 个逼近点",
    "no patch lies to one side of its points; largest mean {mean:+.3f} m, {patch}": "无曲面片偏于数据点一侧；最大平均残差 "
    "{mean:+.3f} m，{patch}",
    "not judged: too few approximated points, {n} where {few} are needed": "不予评判：逼近点仅 {n} 个，需 {few} 个",
    "residuals of neighbours do not hang together (Moran's I {moran:.2f}, z {z:.1f})": "相邻点残差无空间相关（莫兰指数 I "
    "{moran:.2f}，z {z:.1f}）",
    "residuals of neighbours agree: a pattern of about {value:.2f} m that the surface does not follow (Moran's I "
    "{moran:.2f}, z {z:.1f}); more control points, or a source that is off as a whole": "相邻点残差趋同：存在约 {value:.2f} m 而曲面"
    "未能反映的规律（莫兰指数 I {moran:.2f}，z {z:.1f}）；需增加控制点，或某一来源整体偏离",
    "not judged: no residual is beyond the interior tolerance, where the fit stops": "不予评判：残差均未超过内部容差，拟合至此即止",
    "not judged: all residuals are equal": "不予评判：残差全部相等",
    "not judged: most residuals lie at the interior tolerance, where the fit stops; the normal plot leaves its line by "
    "{off:.0%} for that": "不予评判：残差多位于内部容差处，拟合至此即止；正态概率图因此偏离直线 {off:.0%}",
    "the normal plot of the residuals is straight but for {off:.1%}": "残差正态概率图呈直线，偏离仅 {off:.1%}",
    "the residuals are not noise: the normal plot leaves its line by {off:.0%}, with {share:.0%} of the sum of "
    "squares from {few} of {n} points; look at the worst points first": "残差不是随机噪声：正态概率图偏离直线 {off:.0%}，{n} 个点中 {few} 个占"
    "平方和的 {share:.0%}；请先查看残差最大的点",
    "{text}; {part} of {n} points looked at": "{text}；查看了 {n} 个点中的 {part} 个",
    "a bias: the surface runs too low in patch {patch}, {share:.0%} of {n} approximated points lie above it, on average by "
    "{mean:.3f} m": "系统偏差：曲面片 {patch} 偏低，{n} 个逼近点中 {share:.0%} 在其上方，平均 {mean:.3f} m",
    "a bias: the surface runs too high in patch {patch}, {share:.0%} of {n} approximated points lie below it, on average by "
    "{mean:.3f} m": "系统偏差：曲面片 {patch} 偏高，{n} 个逼近点中 {share:.0%} 在其下方，平均 {mean:.3f} m",
    "the surface passes through itself: crossing pairs of triangles: {crossed} (triangles: {n}), one at {x:.1f}, "
    "{y:.1f}, {z:.1f}": "曲面自相交：{n} 个三角形中有 {crossed} 对相交，其一位于 {x:.1f}，{y:.1f}，{z:.1f}",
    "a height field over the map stands once over each place: it cannot cross itself": "平面上的高度场在每一处只有一个值，不会自相交",
    "a height field over its best plane stands once over each place: it cannot cross itself": "最佳平面上的高度场在每一处只有一个值，"
    "不会自相交",
    "no two of {n} triangles between the ends and middles of its spans cross": "各节点区间端点与中点构成的 {n} 个三角形互不相交",
    "places where patches are degenerate (an edge without length, a corner without an angle, control points that "
    "run back): {count}, in {names}; other programs may refuse such a face": "有 {count} 处曲面片退化（边长为零、角为零或控制点倒退）：{names}；"
    "其他软件可能拒收此类面",
    "{count} of {total} places folded or degenerate: the surface turns over there, or its normals look to the other "
    "side": "{total} 处中有 {count} 处折叠或退化：曲面在该处翻转，或法向相反",
    "{count} of {total} places folded or degenerate": "{total} 处中有 {count} 处折叠或退化",
    "no edge, corner or control point of the patches ({n}) has collapsed": "{n} 个曲面片的边、角、控制点均未退化",
    "the surface covers {covered:.0f} of the study area's {wanted:.0f} square metres": "曲面覆盖研究区 {wanted:.0f} m² 中的 "
    "{covered:.0f} m²",
    "the surface covers only {covered:.0f} of the study area's {wanted:.0f} square metres: {off:.1f} % of it have no "
    "surface": "曲面仅覆盖研究区 {wanted:.0f} m² 中的 {covered:.0f} m²：{off:.1f} % 无曲面",
    "the patches cover {covered:.0f} square metres of a study area of {wanted:.0f}: they overlap": "曲面片覆盖 {covered:.0f} m²，"
    "而研究区为 {wanted:.0f} m²：曲面片重叠",
    "the surface runs away where no point holds it: {value:.1f} m off the regional trend at {x:.0f}, {y:.0f}, where the "
    "points depart from it by {shown:.1f} m at most; do not use it there without further points": "曲面在无点控制处偏离：在 {x:.0f}，"
    "{y:.0f} 处偏离区域趋势 {value:.1f} m，而各点最多偏离 {shown:.1f} m；未补充勘探前该处不可采用",
    "away from the points the surface departs from their plane by {value:.1f} m, the points themselves by {shown:.1f} "
    "m": "远离数据点处曲面偏离其平均平面 {value:.1f} m，各点自身偏离 {shown:.1f} m",
}

_FILE = {
    "{places} places on each seam ({count}); largest between {first} and {second}: {value:.2g} {unit}": "{count} 条拼接缝各取 "
    "{places} 处；最大者在 {first} 与 {second} 之间：{value:.2g} {unit}",
    "one face, no seam": "仅一个面，无拼接缝",
    "OpenCASCADE's projection": "由 OpenCASCADE 投影",
    "OpenCASCADE's projection of {count}; ours of the others, at most {apart:.1e} m from it": "{count} 个点由 OpenCASCADE 投影；其余由本"
    "程序投影，两者相差不超过 {apart:.1e} m",
    "the free edges follow the outline": "自由边与轮廓一致",
    "the surface does not reach its whole outline": "曲面未达到全部轮廓",
    "largest distance of {count} core points from the surface in the file ({how})": "核心区 {count} 个点到文件中曲面的最大距离（{how}）",
    "OpenCASCADE's BRepCheck of the shape read": "对读入的形体作 OpenCASCADE BRepCheck 检查",
    "free edges: {free}, edges of the outline: {expected}, closed loops: {loops}": "自由边 {free} 条，轮廓应有 {expected} 条，"
    "闭合为 {loops} 个环",
    "largest tolerance of an edge between faces: a larger one could hide a gap": "面间边的最大容差：过大可能掩盖缝隙",
    "largest tolerance of a free edge: how far the outline's curve may leave the surface": "自由边的最大容差：轮廓曲线可偏离曲面的距离",
    "not trimmed: the free edges are the patches' own": "未裁剪：自由边即曲面片自身的边",
    "all normals lie on one side": "法向均朝同一侧",
    "the normals of neighbouring faces flip": "相邻面法向相反",
    "the surface folds over: no single side, neighbours do not flip": "曲面折叠：无单一朝向，相邻面法向未反转",
    "OpenCASCADE's boolean argument analyser finds the shell crossing itself": "OpenCASCADE 布尔参数分析发现壳体自相交",
    "OpenCASCADE's boolean argument analyser is silent": "OpenCASCADE 布尔参数分析未发现问题",
}

_OFF_DATA = {
    "{beyond} of {total} points left out by {scheme} lie beyond the hull of the others, where every method extrapolates: "
    "error {outer:.3g} m there, {inner:.3g} m within": "按{scheme}留出的 {total} 个点中有 {beyond} 个位于其余点的凸包之外，任何方法在此均为"
    "外推：该处误差 {outer:.3g} m，凸包内 {inner:.3g} m",
    "{share:.0%} of the points left out by {scheme} lie inside the 90 % band ({raw:.0%} before it was held to the places "
    "between the data)": "按{scheme}留出的点有 {share:.0%} 落在 90 % 置信带内（按数据点之间的位置校准前为 {raw:.0%}）",
    "'{name}' was not fitted here: no point can be left out of it": "“{name}”不是在此拟合的，不能留出点",
    "'{name}' was not fitted here: nothing is known about what lies between its points.": "“{name}”不是在此拟合的，其点间情况未知。",
    "{count} points are too many to leave out in groups: each is left out alone, of the regional field, and no other method "
    "is compared": "{count} 个点过多，不能分组留出：按区域场逐点留出，不与其他方法比较",
    "the core is linear across its sections; its left-out errors are those of a cubic one": "核心区在剖面间为线性；其留出误差按三次"
    "插值计算",
    "so many control points: the regional field alone is left out, on a coarser net": "控制点过多：仅对区域场在较粗的网上留出",
    "the error off the data cannot be told: {reason}": "数据点以外的误差无法给出：{reason}",
    "a folded surface has no standard deviation: leaving out its sections is all that can be said": "褶皱曲面没有标准差，只能以留一"
    "剖面法说明",
    "errors are distances from the surface through the other sections; the outermost two stay": "误差为到其余剖面所成曲面的距离；"
    "最外两条剖面不留出",
    "{count} sections are too many to leave out by new fits": "{count} 条剖面过多，不能逐一重新拟合",
    "no point was left out, the band is not calibrated: {reason}": "未作留出检验，置信带未经校准：{reason}",
    "no other method was compared: {reason}": "未与其他方法比较：{reason}",
    "{method} was not compared: {reason}": "未与{method}比较：{reason}",
    "the points have no area: there is no standard deviation between them": "数据点不构成面积，其间没有标准差",
    "no holes are suggested: {reason}": "不建议新孔位：{reason}",
    "the standard deviation is not known: {reason}": "标准差未知：{reason}",
    "a check was not made: {reason}": "一项检查未能进行：{reason}",
    "the dips were not compared: {reason}": "未与产状比较：{reason}",
    "the ground was not compared: {reason}": "未与地面比较：{reason}",
    "{name}: its storage was not compared: {reason}": "{name}：未比较其存储量：{reason}",
    "unforeseen error {kind} ({text}; {place}); please report it": "未预见的错误 {kind}（{text}；{place}），请报告",
    "without {failed} of the sections no surface can be laid": "缺少其中 {failed} 条剖面便不能成面",
}

#: What a task is at.
_STAGES = {
    "start": "启动",
    "read": "读取",
    "read boundary and ground": "读取边界与地面",
    "read boreholes and adits": "读取钻孔与平硐",
    "read sections": "读取剖面",
    "read traces and picks": "读取地质界线与层面点",
    "read the site": "读取场地",
    "read the project": "读取工程",
    "read STEP": "读取 STEP",
    "look at files": "查看文件",
    "imported": "已导入",
    "check rows": "检查各行",
    "compare places": "比较位置",
    "write": "写出",
    "write the sample site": "写出示例场地",
    "conflicts": "查找矛盾点",
    "partition": "分区",
    "fit": "拟合",
    "field": "区域场",
    "periphery": "外围区",
    "robust": "稳健拟合",
    "check": "检验",
    "adjust": "局部调整",
    "done": "完成",
    "fault {name}": "断层 {name}",
    "block {name}": "断块 {name}",
    "push apart": "推开层面",
    "repair": "修正",
    "order": "上下次序",
    "changes by hand": "人工调整",
    "triangles": "三角化",
    "section": "剖面",
    "uncertainty": "不确定性",
    "cross-validation": "交叉验证",
    "calibration": "校准",
    "other methods": "其他方法",
    "next holes": "建议孔位",
    "report": "报告",
    "STEP and read-back": "STEP 与回读",
    "pictures": "图件",
}

SAID = {**_STAGES, **_FIT, **_SETTINGS, **_ERRORS, **_CHECKS, **_FILE, **_OFF_DATA}
