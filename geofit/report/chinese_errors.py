"""What geofit refuses to fit, draw, stitch or write, and what systems say of files, in Chinese."""

from __future__ import annotations

__all__ = ["REFUSED"]

_SENTENCES = {
    "{first} {second}": "{first}{second}",
    "{reason} {remedy}": "{reason}{remedy}",
    "'{name}'": "“{name}”",
    "{where}: {error}": "{where}：{error}",
    "{name}: {stage}": "{name}：{stage}",
}

_SETTINGS = {
    "The language is '{code}'; choose en or zh.": "语言为“{code}”；应取 en 或 zh。",
    "The sample site has no horizon {name!r}; choose one of {names}.": "示例场地没有层面 {name!r}；应取 {names} 之一。",
    "share is {share!r}; a probability above 0 and below 1 is needed, for instance 0.9.": "share 为 {share!r}；应为大于 0 且小于 1 的概率，"
    "例如 0.9。",
    "The contour interval is {step}; give metres above 0.": "等高距为 {step}；应大于 0（m）。",
    "An interval of {step:g} m makes {count} contours from {low:.1f} to {high:.1f} m; give one above {least:.2g} m.": "等高距 {step:g} m "
    "在 {low:.1f} 至 {high:.1f} m 之间将产生 {count} 条等高线；请取大于 {least:.2g} m 的等高距。",
    "The section line has shape {shape}; (k, 2) finite map coordinates are needed.": "剖面线数组的形状为 {shape}；应为 (k, 2) 的有限平面"
    "坐标。",
    "The section line has one place only; give two different ends.": "剖面线仅有一个位置；请给出两个不同的端点。",
    "The chordal tolerance is {tolerance}; give metres above 0.": "弦高容差为 {tolerance}；应大于 0（m）。",
    "The horizons do not stand over one another; there is no thickness between them.": "两层面在平面上不重叠，其间没有厚度。",
    "The cell size is {step}; give metres above 0.": "格网间距为 {step}；应大于 0（m）。",
    "A cell of {step:g} m leaves no grid; the surface is {width:.1f} m wide.": "格网间距 {step:g} m 过大，不能成网；曲面宽 {width:.1f} m。",
    "A cell of {step:g} m makes {count:.3g} cells; give a larger one.": "格网间距 {step:g} m 将产生 {count:.3g} 个格网；请取较大的间距。",
    "A grid of '{kind}' is unknown; choose elevation, deviation or thickness.": "没有“{kind}”格网；应取 elevation、deviation 或 "
    "thickness。",
    "Fault {number} has shape {shape}; a fitted surface or at least two (easting, northing) corners of its trace are "
    "needed.": "第 {number} 条断层数组的形状为 {shape}；应为拟合的曲面，或其迹线上至少两个角点（东坐标，北坐标）。",
    "A block of '{name}' is called '{block}', and so is a horizon. Rename the horizon.": "“{name}”的一个断块名为“{block}”，与某层面同名。"
    "请更改该层面的名称。",
}

_POINTS = {
    "xyz must hold numbers: {error}. Give an (n, 3) array of metres.": "xyz 应为数字：{error}。请给出 (n, 3) 数组（m）。",
    "xyz has shape {shape}; an (n, 3) array of easting, northing, elevation is needed.": "xyz 的形状为 {shape}；应为 (n, 3) 数组：东坐标、"
    "北坐标、高程。",
    "{count} of {total} points are not finite, the first at index {index}: {place}. Remove or complete them before "
    "fitting.": "{total} 个点中有 {count} 个不是有限数，首个序号为 {index}：{place}。请在拟合前删除或补全。",
    "accuracy[{index}] is {value:g} m; one standard deviation must be above 0. Use nan where the source states none.": "accuracy[{index}] "
    "为 {value:g} m；一倍标准差应大于 0。资料未注明精度处请用 nan。",
    "{name} cannot be read as {type}: {error}.": "{name} 不能读作 {type}：{error}。",
    "{name} has shape {shape}; {n} points need shape ({n},) or one value for all.": "{name} 的形状为 {shape}；{n} 个点应为 ({n},)，"
    "或全部点共用一个值。",
}

_FITS = {
    "Control points held by neither data nor energy: {count}. Use fewer knots, or a larger smoothing.": "{count} 个控制点既无数据也无"
    "能量项约束。请减少节点，或增大光滑系数。",
    "The system of the fit is not positive definite: too few points, or points that contradict each other, leave control "
    "points free. Use fewer knots, or a larger smoothing.": "拟合方程组非正定：点数过少或点间相互矛盾，使部分控制点不受约束。请减少节点，"
    "或增大光滑系数。",
    "The posterior of the fit is improper: some control points are held by nothing.": "拟合的后验分布不正常：部分控制点不受任何约束。",
    "The posterior of the fit is improper: points and energy leave control points free.": "拟合的后验分布不正常：数据点与能量项未能约束"
    "全部控制点。",
    "A parametric surface is no height field, and has no posterior. Leave out its sections instead.": "参数曲面不是高度场，没有后验分布。"
    "请改用留一剖面法。",
    "A surface over its best plane needs (n, 3) coordinates; (n, 2) were given.": "展布于最佳平面的曲面需 (n, 3) 坐标；所给为 (n, 2)。",
    "No standard deviation is known of '{name}'; see the notes of its examination.": "“{name}”的标准差未知；请见其检验说明。",
    "Control point ({i}, {j}) of patch '{patch}' acts on points that are met exactly ({count}: {names}). Move one that lies "
    "farther from them, or exclude them first.": "曲面片“{patch}”的控制点（{i}，{j}）影响精确通过的点（{count} 个：{names}）。请移动离其"
    "较远的控制点，或先剔除这些点。",
    "Control point ({i}, {j}) of patch '{patch}' acts on points that are met exactly ({count}: {names}); its weight stays "
    "1.": "曲面片“{patch}”的控制点（{i}，{j}）影响精确通过的点（{count} 个：{names}），其权重保持 1。",
    "The surface cannot be pulled to {name}: the points around it that are met exactly ({count}) leave no freedom. Exclude "
    "the one that is wrong, or fit with core='none'.": "曲面不能拉近到 {name}：其周围精确通过的点（{count} 个）未留余地。请剔除有误的点，"
    "或以 core='none' 拟合。",
    "Patch '{name}' has control points (0, 0) to ({rows}, {columns}); ({i}, {j}) was given.": "曲面片“{name}”的控制点为（0，0）至"
    "（{rows}，{columns}）；所给为（{i}，{j}）。",
    "The point is {point!r}; three finite map coordinates (easting, northing, elevation) are needed.": "所给点为 {point!r}；应为三个有限的"
    "坐标（东坐标、北坐标、高程）。",
    "'{name}' has points 0 to {last}; {point} was given.": "“{name}”的点序号为 0 至 {last}；所给为 {point}。",
}

_STITCH = {
    "'{name}' has no patch; a surface needs at least one.": "“{name}”没有曲面片；曲面至少需一个。",
    "'{name}' does not reach into its outline; give an outline that it covers.": "“{name}”未进入其轮廓；请给出其所覆盖的轮廓。",
    "'{name}': the free edges of the sewn shell make {loops} loops; the outer boundary alone makes one. {reason}": "“{name}”：缝合壳体的"
    "自由边构成 {loops} 个环，而外边界仅为一个。{reason}",
    "OpenCASCADE finds the sewn shell of '{name}' invalid (BRepCheck). Look for collapsed edges or patches folded onto "
    "themselves; fit again with fewer control points or another frame.": "OpenCASCADE 判定“{name}”的缝合壳体无效（BRepCheck）。请查找"
    "退化的边或自身折叠的曲面片；以较少的控制点或其他坐标架重新拟合。",
    "The patches of '{name}' make no full grid of parameter ranges with one degree: {names}. Use the sewn shell "
    "instead.": "“{name}”的曲面片不能组成次数相同的完整参数格网：{names}。请改用缝合壳体。",
    "{name} {domain} degree {degree}": "{name} {domain} 次数 {degree}",
    "Neighbouring patches differ in their knots (one ends at {end:g}, the next starts at {start:g}). Only restrictions of "
    "one tensor-product surface can be merged.": "相邻曲面片的节点不同（前者止于 {end:g}，后者始于 {start:g}）。只有同一张量积曲面的各部分"
    "才能合并。",
    "Neighbouring patches gape by {apart:.3g} m; at most {limit:g} m can be merged.": "相邻曲面片间有 {apart:.3g} m 的缝隙；最大 "
    "{limit:g} m 方可合并。",
    "{first} and {second} gape by {gap:.3g} m": "{first} 与 {second} 间缝隙 {gap:.3g} m",
    "Patches of '{name}' do not share their edges: {places}. At most {limit:g} m is needed: give neighbours the same edge "
    "row of control points.": "“{name}”的曲面片边缘不重合：{places}。缝隙不得超过 {limit:g} m：请使相邻曲面片的边缘控制点相同。",
    "The patches of '{name}' ({names}) make {shells} separate pieces; one connected surface is needed. Check the outline, "
    "and that neighbours run along whole edges.": "“{name}”的曲面片（{names}）分为 {shells} 块；应为一个连通的曲面。请检查轮廓，以及相邻"
    "曲面片是否整边相接。",
}

_EXPORT = {
    "There is no horizon '{name}'": "没有层面“{name}”",
    "The horizons are: {names}.": "现有层面：{names}。",
    "No fault of the site cuts '{name}'": "场地中没有断层切割“{name}”",
    'Write F1 = ["{name}"] under [faults].': '请在 [faults] 下写 F1 = ["{name}"]。',
    "Name another one with --out.": "请以 --out 另行指定。",
    "The folder cannot be made: {error}": "不能建立文件夹：{error}",
    "No surface to write": "没有可写出的曲面",
    "Give at least one horizon.": "请至少给出一个层面。",
    "Give it in the surfaces' map coordinates, metres.": "请以曲面所用的平面坐标给出（m）。",
    "Give x0,y0,x1,y1, metres; further corners add two numbers each.": "请给出 x0,y0,x1,y1（m）；每增加一个角点增加两个数。",
    "Give a file with columns x and y, or x0,y0,x1,y1.": "请给出含 x、y 两列的文件，或 x0,y0,x1,y1。",
    "Give them with --points.": "请以 --points 给出。",
    "There is no format '{to}'": "没有“{to}”格式",
    "Choose one of: {names}.": "应取以下之一：{names}。",
    "Choose {names}.": "请选择 {names}。",
    "The section line from {first} to {last} meets no horizon": "自 {first} 至 {last} 的剖面线不与任何层面相交",
    "Numbers given for the section line: {count}": "剖面线给出 {count} 个数",
    "'{name}' is a triangle mesh; {to} holds NURBS surfaces, which would have to be fitted": "“{name}”是三角网；{to} 存放 NURBS 曲面，须先"
    "拟合",
    "Fit its vertices (geofit fit), or choose one of: {names}.": "请拟合其顶点（geofit fit），或取以下之一：{names}。",
    "Name the upper one, then the lower.": "请先写上层面，再写下层面。",
    "There are no points of '{name}'": "没有“{name}”的点",
    "The file is given twice": "文件重复给出",
    "Name each file once.": "请每个文件只写一次。",
    "Thickness lies between two horizons; given: {count}": "厚度指两个层面之间；现给出 {count} 个",
    "OpenCASCADE cannot write the file": "OpenCASCADE 不能写出文件",
    "OpenCASCADE cannot write IGES": "OpenCASCADE 不能写出 IGES",
    "Check the folder and the disk.": "请检查文件夹与磁盘。",
    "Check the disk.": "请检查磁盘。",
    "Write STEP instead.": "请改写为 STEP。",
    "Writing {format}": "写出 {format}",
    "There is no contour to write": "没有可写出的等高线",
    "Choose a smaller interval.": "请取较小的等高距。",
    "Check the path; give the system as EPSG:number, or none: --crs ''.": "请检查路径；坐标系写作 EPSG:编号，或不写：--crs ''。",
    "The file cannot be written: {error}": "文件不能写出：{error}",
    "No cell of the grid has a value": "格网中没有任何数值",
    "Choose a cell size below the surface's size.": "请取小于曲面尺寸的格网间距。",
    "Sample the surface on a grid with one step.": "请以单一间距的格网取样。",
    "Give one as EPSG:number, or none: --crs ''.": "请写作 EPSG:编号，或不写：--crs ''。",
    "The cells are from {least:g} to {most:g} m wide; the format needs square cells": "格网宽 {least:g} 至 {most:g} m；该格式要求正方形格网",
    "The coordinate system is unknown: {error}": "坐标系未知：{error}",
    "Write it as STEP, OBJ or GOCAD TSurf.": "请写为 STEP、OBJ 或 GOCAD TSurf。",
    "'{name}' is upright or overturned in places; a LandXML TIN has one elevation a place": "“{name}”局部直立或倒转；LandXML 的不规则三角网"
    "每处只有一个高程",
    "Give the deviations with their points, one for each.": "请给出与点一一对应的偏差。",
    "Deviations given: {count}; points: {points}": "给出偏差 {count} 个，点 {points} 个",
    "A STEP file in '{unit}' is unknown": "不能以“{unit}”为单位写出 STEP 文件",
    "Make the folder, or name another.": "请建立该文件夹，或另行指定。",
    "{what} needs the package {package}, which cannot be imported ({error}). Install it: pip install "
    "'geofit[{extra}]'": "{what}需要程序包 {package}，但不能载入（{error}）。请安装：pip install 'geofit[{extra}]'",
    "Install one (Debian and Ubuntu: apt-get install fonts-noto-cjk; Windows has Microsoft YaHei among its optional "
    "features) and run again.": "请安装后重新运行（Debian 与 Ubuntu：apt-get install fonts-noto-cjk；Windows 可在可选功能中添加微软雅黑）。",
    "A Chinese report needs a font with Chinese characters, and this machine has none. {install}": "中文报告需要中文字体，而本机没有。"
    "{install}",
    "No font on this machine has the characters of '{text}': pictures and PDF show boxes in their place. {install} Tables "
    "and text of the HTML and the JSON are complete.": "本机没有字体包含“{text}”中的字符：图件与 PDF 中将显示为方框。{install}HTML 的表格、"
    "文字与 JSON 不受影响。",
    "The 3D picture is missing: this machine has no OpenGL library. Install one (Debian and Ubuntu: apt-get install libgl1 "
    "libegl1 libxrender1) and run again.": "缺三维图：本机没有 OpenGL 库。请安装后重新运行（Debian 与 Ubuntu：apt-get install libgl1 libegl1 "
    "libxrender1）。",
}

#: What Linux, macOS and Windows say of files.
_SYSTEM = {
    "Operation not permitted": "不允许该操作",
    "No such file or directory": "没有该文件或文件夹",
    "Input/output error": "磁盘读写错误",
    "Permission denied": "没有访问权限",
    "Device or resource busy": "正被其他程序使用",
    "File exists": "文件已存在",
    "Invalid cross-device link": "不能跨磁盘移动",
    "No such device": "没有该设备",
    "Not a directory": "不是文件夹",
    "Is a directory": "是文件夹，不是文件",
    "Invalid argument": "参数无效（文件名可能含有不允许的字符）",
    "Too many open files": "打开的文件过多",
    "Too many open files in system": "系统中打开的文件过多",
    "Text file busy": "正被其他程序使用",
    "File too large": "文件过大",
    "No space left on device": "磁盘已满",
    "Read-only file system": "磁盘为只读",
    "File name too long": "文件名过长",
    "Directory not empty": "文件夹不为空",
    "Too many levels of symbolic links": "符号链接循环",
    "Disk quota exceeded": "超出磁盘配额",
    "Stale file handle": "网络文件已失效",
    "Connection timed out": "连接超时",
    "Resource temporarily unavailable": "暂时不可用",
    "Access is denied": "没有访问权限",
    "The system cannot find the file specified": "没有该文件",
    "The system cannot find the path specified": "没有该文件夹",
    "The process cannot access the file because it is being used by another process": "文件正被其他程序使用",
    "The network path was not found": "找不到网络路径",
    "The network name cannot be found": "找不到网络名称",
    "The device is not ready": "设备未就绪",
    "The disk is full": "磁盘已满",
    "There is not enough space on the disk": "磁盘已满",
    "The media is write protected": "磁盘为只读",
    "The filename, directory name, or volume label syntax is incorrect": "文件名或路径含有不允许的字符",
    "The directory is not empty": "文件夹不为空",
    "Cannot create a file when that file already exists": "文件已存在",
}

REFUSED = {**_SENTENCES, **_SETTINGS, **_POINTS, **_FITS, **_STITCH, **_EXPORT, **_SYSTEM}
