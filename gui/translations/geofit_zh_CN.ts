<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE TS>
<TS version="2.1" language="zh_CN" sourcelanguage="en">
<context>
    <name>Actions</name>
    <message>
        <source>&amp;New from files…</source>
        <extracomment>name: text, key, tooltip, icon. Texts are translated where the actions are made.</extracomment>
        <translation>由文件新建(&amp;N)...</translation>
    </message>
    <message>
        <source>Import tables, drawings and grids as a new site</source>
        <translation>导入表格、图件和格网，建立新场地</translation>
    </message>
    <message>
        <source>&amp;Open…</source>
        <translation>打开(&amp;O)...</translation>
    </message>
    <message>
        <source>Open a project (*.geofit) or a site file (site.toml)</source>
        <translation>打开工程（*.geofit）或场地文件（site.toml）</translation>
    </message>
    <message>
        <source>Open sam&amp;ple site</source>
        <translation>打开示例场地(&amp;P)</translation>
    </message>
    <message>
        <source>A fictional dam site with five horizons, to try things out</source>
        <translation>虚构的坝址，含五个层面，供试用</translation>
    </message>
    <message>
        <source>&amp;Save</source>
        <translation>保存(&amp;S)</translation>
    </message>
    <message>
        <source>Save the project with its surfaces</source>
        <translation>保存工程及其曲面</translation>
    </message>
    <message>
        <source>Save &amp;as…</source>
        <translation>另存为(&amp;A)...</translation>
    </message>
    <message>
        <source>&amp;Export STEP…</source>
        <translation>导出 STEP(&amp;E)...</translation>
    </message>
    <message>
        <source>Write STEP for CAD, and read the file back</source>
        <translation>写出供 CAD 使用的 STEP 文件，并回读检验</translation>
    </message>
    <message>
        <source>Export &amp;other formats…</source>
        <translation>导出其他格式(&amp;O)...</translation>
    </message>
    <message>
        <source>&amp;Report…</source>
        <translation>报告(&amp;R)...</translation>
    </message>
    <message>
        <source>Accuracy report as HTML or PDF, in English or Chinese</source>
        <translation>精度检验报告，HTML 或 PDF，中文或英文</translation>
    </message>
    <message>
        <source>S&amp;creenshot…</source>
        <translation>截图(&amp;C)...</translation>
    </message>
    <message>
        <source>Picture of the 3D view at print size</source>
        <translation>按打印尺寸输出三维视图图片</translation>
    </message>
    <message>
        <source>Import pro&amp;blems…</source>
        <translation>导入问题(&amp;B)...</translation>
    </message>
    <message>
        <source>Rows that were not used, and why</source>
        <translation>未采用的行及原因</translation>
    </message>
    <message>
        <source>&amp;Close site</source>
        <translation>关闭场地(&amp;C)</translation>
    </message>
    <message>
        <source>&amp;Quit</source>
        <translation>退出(&amp;Q)</translation>
    </message>
    <message>
        <source>Re&amp;name site…</source>
        <translation>重命名场地(&amp;N)...</translation>
    </message>
    <message>
        <source>&amp;Preferences…</source>
        <translation>首选项(&amp;P)...</translation>
    </message>
    <message>
        <source>&amp;Show all</source>
        <translation>显示全部(&amp;S)</translation>
    </message>
    <message>
        <source>Move the camera so that everything is seen</source>
        <translation>移动视角，显示全部内容</translation>
    </message>
    <message>
        <source>From the &amp;top</source>
        <translation>俯视(&amp;T)</translation>
    </message>
    <message>
        <source>Towards &amp;north</source>
        <translation>向北看(&amp;N)</translation>
    </message>
    <message>
        <source>Towards &amp;south</source>
        <translation>向南看(&amp;S)</translation>
    </message>
    <message>
        <source>Towards &amp;east</source>
        <translation>向东看(&amp;E)</translation>
    </message>
    <message>
        <source>Towards &amp;west</source>
        <translation>向西看(&amp;W)</translation>
    </message>
    <message>
        <source>Fr&amp;om a corner</source>
        <translation>轴测视图(&amp;O)</translation>
    </message>
    <message>
        <source>&amp;Next panel</source>
        <translation>下一面板(&amp;N)</translation>
    </message>
    <message>
        <source>Give the keyboard to the next panel</source>
        <translation>将键盘焦点移到下一面板</translation>
    </message>
    <message>
        <source>Pre&amp;vious panel</source>
        <translation>上一面板(&amp;V)</translation>
    </message>
    <message>
        <source>Give the keyboard to the panel before</source>
        <translation>将键盘焦点移到上一面板</translation>
    </message>
    <message>
        <source>&amp;Reset panels</source>
        <translation>恢复面板布局(&amp;R)</translation>
    </message>
    <message>
        <source>Put every panel back where it was at first</source>
        <translation>将各面板放回初始位置</translation>
    </message>
    <message>
        <source>&amp;Fit</source>
        <translation>拟合(&amp;F)</translation>
    </message>
    <message>
        <source>Fit the chosen horizon with its settings</source>
        <translation>按当前设置拟合所选层面</translation>
    </message>
    <message>
        <source>Fit &amp;all</source>
        <translation>全部拟合(&amp;A)</translation>
    </message>
    <message>
        <source>Fit what has no surface or a stale one</source>
        <translation>拟合尚无曲面或曲面已过时的层面</translation>
    </message>
    <message>
        <source>&amp;Examine off the data</source>
        <translation>检验数据点以外(&amp;E)</translation>
    </message>
    <message>
        <source>Cross-validate: how far the rock may lie elsewhere</source>
        <translation>交叉验证：无数据处岩层可能偏离多少</translation>
    </message>
    <message>
        <source>Check the &amp;order</source>
        <translation>检查上下次序(&amp;O)</translation>
    </message>
    <message>
        <source>Whether each horizon stays above the next one</source>
        <translation>各层面是否始终位于下一层面之上</translation>
    </message>
    <message>
        <source>O&amp;rder of the horizons…</source>
        <translation>层面上下次序(&amp;R)...</translation>
    </message>
    <message>
        <source>Say which horizon lies above which</source>
        <translation>指定层面的上下次序</translation>
    </message>
    <message>
        <source>&amp;Push apart…</source>
        <translation>推开相交层面(&amp;P)...</translation>
    </message>
    <message>
        <source>Push horizons apart where they cross; points met exactly stay</source>
        <translation>在相交处推开层面；精确通过的点保持不变</translation>
    </message>
    <message>
        <source>Go to the &amp;worst point</source>
        <translation>转到残差最大点(&amp;W)</translation>
    </message>
    <message>
        <source>E&amp;xclude or include the chosen row</source>
        <translation>剔除或恢复所选行(&amp;X)</translation>
    </message>
    <message>
        <source>&amp;Stop the task</source>
        <translation>停止任务(&amp;S)</translation>
    </message>
    <message>
        <source>&amp;Tutorial</source>
        <translation>教程(&amp;T)</translation>
    </message>
    <message>
        <source>&amp;Keyboard shortcuts</source>
        <translation>快捷键(&amp;K)</translation>
    </message>
    <message>
        <source>&amp;System report</source>
        <translation>系统信息(&amp;S)</translation>
    </message>
    <message>
        <source>&amp;About geofit</source>
        <translation>关于 geofit(&amp;A)</translation>
    </message>
    <message>
        <source>&amp;Orthographic</source>
        <translation>正投影(&amp;O)</translation>
    </message>
    <message>
        <source>Parallel lines stay parallel: for measuring</source>
        <translation>平行线保持平行，便于量测</translation>
    </message>
    <message>
        <source>&amp;Clip box</source>
        <translation>裁剪框(&amp;C)</translation>
    </message>
    <message>
        <source>Show only what lies within a box that can be dragged</source>
        <translation>只显示可拖动的框内的内容</translation>
    </message>
    <message>
        <source>Control &amp;points</source>
        <translation>控制点(&amp;P)</translation>
    </message>
    <message>
        <source>Show the control points of the chosen horizon</source>
        <translation>显示所选层面的控制点</translation>
    </message>
    <message>
        <source>S&amp;eams</source>
        <translation>拼接缝(&amp;E)</translation>
    </message>
    <message>
        <source>Colour the seams of the chosen horizon by gap and angle</source>
        <translation>按缝隙和夹角为所选层面的拼接缝着色</translation>
    </message>
    <message>
        <source>&amp;Measure</source>
        <translation>量测(&amp;M)</translation>
    </message>
    <message>
        <source>Click two points: distance, difference in height, dip</source>
        <translation>点取两点：距离、高差、倾角</translation>
    </message>
    <message>
        <source>&amp;Section</source>
        <translation>剖面(&amp;S)</translation>
    </message>
    <message>
        <source>Cut the horizons along a line that can be dragged</source>
        <translation>沿可拖动的直线剖切各层面</translation>
    </message>
    <message>
        <source>As the system</source>
        <translation>跟随系统</translation>
    </message>
    <message>
        <source>Light</source>
        <translation>浅色</translation>
    </message>
    <message>
        <source>Dark</source>
        <translation>深色</translation>
    </message>
</context>
<context>
    <name>ActivityBar</name>
    <message>
        <source>Progress</source>
        <translation>进度</translation>
    </message>
    <message>
        <source>Stop the task (Esc)</source>
        <translation>停止任务 (Esc)</translation>
    </message>
    <message>
        <source>Stop the task</source>
        <translation>停止任务</translation>
    </message>
    <message>
        <source>Easting, northing and elevation under the pointer, without exaggeration</source>
        <translation>指针处的东坐标、北坐标和高程（不含竖向放大）</translation>
    </message>
</context>
<context>
    <name>AdjustPanel</name>
    <message>
        <source>Control point</source>
        <extracomment>Wait for the next step before an effect is asked for, milliseconds.</extracomment>
        <translation>控制点</translation>
    </message>
    <message>
        <source>Data point</source>
        <translation>数据点</translation>
    </message>
    <message>
        <source>Apply</source>
        <translation>应用</translation>
    </message>
    <message>
        <source>Change the surface. Undo takes it back.</source>
        <translation>修改曲面；可撤销。</translation>
    </message>
    <message>
        <source>Back to zero</source>
        <translation>归零</translation>
    </message>
    <message>
        <source>No surface yet: press Fit, then change it by hand where you know better.</source>
        <translation>尚无曲面：先点“拟合”，再在您更有把握之处手工调整。</translation>
    </message>
    <message>
        <source>This surface was read from a file: it has no control net of its own. Fit it, then adjust.</source>
        <translation>该曲面读自文件，没有自己的控制网。请先拟合，再调整。</translation>
    </message>
</context>
<context>
    <name>ChecksPanel</name>
    <message>
        <source>Checks of the surface</source>
        <translation>曲面检查</translation>
    </message>
    <message>
        <source>Check</source>
        <translation>检查项</translation>
    </message>
    <message>
        <source>Result</source>
        <translation>结果</translation>
    </message>
    <message>
        <source>Value</source>
        <translation>数值</translation>
    </message>
    <message>
        <source>Limit</source>
        <translation>限值</translation>
    </message>
    <message>
        <source>In words</source>
        <translation>说明</translation>
    </message>
    <message>
        <source>Copy</source>
        <translation>复制</translation>
    </message>
    <message>
        <source>No surface yet: press Fit, and every check of it is listed here.</source>
        <translation>尚无曲面：点“拟合”后，各项检查列于此处。</translation>
    </message>
    <message>
        <source>Surface</source>
        <translation>曲面</translation>
    </message>
    <message>
        <source>Order of horizons</source>
        <translation>层面上下次序</translation>
    </message>
    <message>
        <source>Throw at faults</source>
        <translation>断层落差</translation>
    </message>
    <message>
        <source>Away from the data</source>
        <translation>数据点以外</translation>
    </message>
    <message>
        <source>Conflicts</source>
        <translation>矛盾点</translation>
    </message>
    <message>
        <source>Notes</source>
        <translation>说明</translation>
    </message>
    <message>
        <source>STEP file read back</source>
        <translation>STEP 文件回读</translation>
    </message>
    <message>
        <source>not applicable</source>
        <translation>不适用</translation>
    </message>
    <message>
        <source>passed</source>
        <translation>合格</translation>
    </message>
    <message>
        <source>failed</source>
        <translation>不合格</translation>
    </message>
    <message>
        <source>standard deviation of all {n} points from the surface</source>
        <translation>全部 {n} 个点到曲面的中误差</translation>
    </message>
    <message>
        <source>{upper} above {lower}</source>
        <translation>{upper} 在 {lower} 之上</translation>
    </message>
    <message>
        <source>{up} above {down}, at {fault}</source>
        <translation>{fault}：{up} 高于 {down}</translation>
    </message>
    <message>
        <source>holes left out</source>
        <translation>留一钻孔法</translation>
    </message>
    <message>
        <source>sections left out</source>
        <translation>留一剖面法</translation>
    </message>
    <message>
        <source>blocks left out</source>
        <translation>留一分块法</translation>
    </message>
    <message>
        <source>Faces: {faces}, free edges: {edges}, edge tolerance {tolerance:.1e} m</source>
        <translation>面 {faces} 个，自由边 {edges} 条，边容差 {tolerance:.1e} m</translation>
    </message>
    <message>
        <source>for knowledge</source>
        <translation>供参考</translation>
    </message>
    <message>
        <source>{share:.0f} % of the left-out points lie in the 90 % band; mean error {bias:+.2f} m</source>
        <translation>留出点有 {share:.0f} % 落在 90 % 置信带内；平均误差 {bias:+.2f} m</translation>
    </message>
    <message>
        <source>gave way</source>
        <translation>舍去</translation>
    </message>
</context>
<context>
    <name>ControlPointPage</name>
    <message>
        <source>Patch</source>
        <extracomment>Steps of the buttons, metres.</extracomment>
        <translation>曲面片</translation>
    </message>
    <message>
        <source>Row</source>
        <translation>行</translation>
    </message>
    <message>
        <source>Column</source>
        <translation>列</translation>
    </message>
    <message>
        <source>Move by</source>
        <translation>移动</translation>
    </message>
    <message>
        <source>Elevation</source>
        <translation>高程</translation>
    </message>
    <message>
        <source> m</source>
        <translation> m</translation>
    </message>
    <message>
        <source>Elevation of the control point; the surface follows it part of the way.</source>
        <translation>控制点的高程；曲面只部分跟随移动。</translation>
    </message>
    <message>
        <source>Move by {step:+g} m</source>
        <translation>移动 {step:+g} m</translation>
    </message>
    <message>
        <source>Weight</source>
        <translation>权重</translation>
    </message>
    <message>
        <source>Row of the control point, 0 to {most}.</source>
        <translation>控制点的行号，0 至 {most}。</translation>
    </message>
    <message>
        <source>Column of the control point, 0 to {most}.</source>
        <translation>控制点的列号，0 至 {most}。</translation>
    </message>
    <message>
        <source>At ({x:.1f}, {y:.1f}, {z:.2f})</source>
        <translation>位于（{x:.1f}，{y:.1f}，{z:.2f}）</translation>
    </message>
    <message>
        <source>Moves the surface in a field of {width:.0f} m × {height:.0f} m around it, and nothing outside. Data points there: {n}.</source>
        <translation>只影响其周围 {width:.0f} m × {height:.0f} m 范围内的曲面，范围外不变。其中有数据点 {n} 个。</translation>
    </message>
    <message>
        <source>It is held by points that are met exactly: {n}. Choose one farther from them, or exclude them.</source>
        <translation>它受 {n} 个精确通过的点制约。请选择离这些点较远的控制点，或先剔除这些点。</translation>
    </message>
</context>
<context>
    <name>DataPointPage</name>
    <message>
        <source> %</source>
        <translation> %</translation>
    </message>
    <message>
        <source>Share of the distance</source>
        <translation>距离的百分比</translation>
    </message>
    <message>
        <source>100 % lets the surface pass through the point, 50 % takes half of the distance away.</source>
        <translation>100 % 使曲面通过该点，50 % 使距离减半。</translation>
    </message>
    <message>
        <source>The control points around the point move as little as possible. Points that are met exactly stay exact, and may leave no freedom.</source>
        <translation>该点周围的控制点移动量取最小。精确通过的点保持精确，可能不留余地。</translation>
    </message>
    <message>
        <source>Pull by</source>
        <translation>拉近</translation>
    </message>
    <message>
        <source>Choose a point in the view or in the residual table.</source>
        <translation>在三维视图或残差表中选取一点。</translation>
    </message>
    <message>
        <source>{point}
Elevation {z:.3f} m
Residual {d:+.3f} m</source>
        <translation>{point}
高程 {z:.3f} m
残差 {d:+.3f} m</translation>
    </message>
    <message>
        <source>The surface meets this point already.</source>
        <translation>曲面已通过该点。</translation>
    </message>
</context>
<context>
    <name>DataTable</name>
    <message>
        <source>Copy</source>
        <extracomment>Pixels that are put between columns where there is room.</extracomment>
        <translation>复制</translation>
    </message>
    <message>
        <source>Export as CSV…</source>
        <translation>导出 CSV...</translation>
    </message>
    <message>
        <source>Export as CSV</source>
        <translation>导出 CSV</translation>
    </message>
    <message>
        <source>Comma-separated values (*.csv)</source>
        <translation>逗号分隔文件 (*.csv)</translation>
    </message>
</context>
<context>
    <name>Delivering</name>
    <message>
        <source>Export</source>
        <extracomment>File endings of the formats that are named otherwise. Times the view&apos;s own size: an A4 page at 300 dots an inch from half a screen. By horizon: the surface that was exported last, and the file that holds it.</extracomment>
        <translation>导出</translation>
    </message>
    <message>
        <source>Export {name}</source>
        <translation>导出 {name}</translation>
    </message>
    <message>
        <source>Screenshot</source>
        <translation>截图</translation>
    </message>
    <message>
        <source>Pictures (*.png)</source>
        <translation>图片 (*.png)</translation>
    </message>
    <message>
        <source>There is no surface to write yet. Press Fit first.</source>
        <translation>尚无可写出的曲面。请先拟合。</translation>
    </message>
    <message>
        <source>Wrote {names}.</source>
        <translation>已写出 {names}。</translation>
    </message>
</context>
<context>
    <name>Desktop</name>
    <message>
        <source>Wait for the task to end, then choose the language.</source>
        <translation>请等任务结束后再选择语言。</translation>
    </message>
</context>
<context>
    <name>Effect</name>
    <message>
        <source>Effect: move or pull, and the deviation before and after stands here.</source>
        <translation>效果：移动或拉近后，调整前后的偏差列于此处。</translation>
    </message>
    <message>
        <source>Effect</source>
        <translation>效果</translation>
    </message>
    <message>
        <source>before</source>
        <translation>调整前</translation>
    </message>
    <message>
        <source>after</source>
        <translation>调整后</translation>
    </message>
    <message>
        <source>σ, m</source>
        <translation>σ, m</translation>
    </message>
    <message>
        <source>max |d|, m</source>
        <translation>最大 |d|, m</translation>
    </message>
    <message>
        <source>worst point&apos;s d, m</source>
        <translation>最大残差点的 d, m</translation>
    </message>
    <message>
        <source>{before} → {after}</source>
        <translation>{before} → {after}</translation>
    </message>
</context>
<context>
    <name>ErrorDialog</name>
    <message>
        <source>geofit</source>
        <translation>geofit</translation>
    </message>
    <message>
        <source>{task} did not work.</source>
        <translation>“{task}”未能完成。</translation>
    </message>
    <message>
        <source>Something failed.</source>
        <translation>操作失败。</translation>
    </message>
    <message>
        <source>&amp;Details</source>
        <translation>详细信息(&amp;D)</translation>
    </message>
    <message>
        <source>&amp;Copy details</source>
        <translation>复制详细信息(&amp;C)</translation>
    </message>
    <message>
        <source>{reason}

Check that the folder is there, can be written, and has room.</source>
        <translation>{reason}

请确认文件夹存在、可写且有足够空间。</translation>
    </message>
    <message>
        <source>There is not enough memory. Close other programs, or work with fewer points.</source>
        <translation>内存不足。请关闭其他程序，或减少点数。</translation>
    </message>
    <message>
        <source>This is a mistake in geofit, not in your data. Your work is still here: save it. Then copy the details and send them to whoever looks after geofit.

{error}</source>
        <translation>这是 geofit 的错误，与您的数据无关。您的工作仍在，请先保存；然后复制详细信息，发送给 geofit 的维护人员。

{error}</translation>
    </message>
</context>
<context>
    <name>ExportDialog</name>
    <message>
        <source>Export STEP</source>
        <translation>导出 STEP</translation>
    </message>
    <message>
        <source>metres</source>
        <translation>米</translation>
    </message>
    <message>
        <source>millimetres</source>
        <translation>毫米</translation>
    </message>
    <message>
        <source>The file says which unit it has, and CAD systems convert. The surfaces are the same.</source>
        <translation>文件注明其单位，CAD 软件会自动换算；曲面相同。</translation>
    </message>
    <message>
        <source>&amp;One file</source>
        <translation>合为一个文件(&amp;O)</translation>
    </message>
    <message>
        <source>One file a &amp;horizon</source>
        <translation>每个层面一个文件(&amp;H)</translation>
    </message>
    <message>
        <source>What the reader found in the file</source>
        <translation>回读检验结果</translation>
    </message>
    <message>
        <source>&amp;Write</source>
        <translation>写出(&amp;W)</translation>
    </message>
    <message>
        <source>Open &amp;folder</source>
        <translation>打开文件夹(&amp;F)</translation>
    </message>
    <message>
        <source>After writing, OpenCASCADE reads the file back; what it finds is listed here.</source>
        <translation>写出后由 OpenCASCADE 回读文件，检验结果列于此处。</translation>
    </message>
    <message>
        <source>Horizons to write</source>
        <translation>要写出的层面</translation>
    </message>
    <message>
        <source>&amp;Browse…</source>
        <translation>浏览(&amp;B)...</translation>
    </message>
    <message>
        <source>in map coordinates, ISO 10303-242 (AP242)</source>
        <translation>地图坐标，ISO 10303-242（AP242）</translation>
    </message>
    <message>
        <source>Hori&amp;zons</source>
        <translation>层面(&amp;Z)</translation>
    </message>
    <message>
        <source>F&amp;ile</source>
        <translation>文件(&amp;I)</translation>
    </message>
    <message>
        <source>&amp;Unit</source>
        <translation>单位(&amp;U)</translation>
    </message>
    <message>
        <source>STEP files (*.step *.stp)</source>
        <translation>STEP 文件 (*.step *.stp)</translation>
    </message>
    <message>
        <source>Writing, and reading back what was written…</source>
        <translation>正在写出并回读……</translation>
    </message>
    <message>
        <source>Stopped. A file that was not finished is not there.</source>
        <translation>已停止。未完成的文件不会留下。</translation>
    </message>
    <message>
        <source>Wrote {names} ({size}). Every check of the file holds.</source>
        <translation>已写出 {names}（{size}）。文件的各项检查均合格。</translation>
    </message>
    <message>
        <source>Wrote {names} ({size}), but the file does not hold what it should for: {bad}. Look at the failed checks below; fit these horizons with a smaller tolerance or another core before you pass the file on.</source>
        <translation>已写出 {names}（{size}），但下列层面的文件检查不合格：{bad}。请查看下列不合格项；用更小的容差或其他核心区重新拟合这些层面后，再提交文件。</translation>
    </message>
    <message>
        <source>{faces} faces; σ of all points from the surface in the file</source>
        <translation>{faces} 个面；全部点到文件中曲面的中误差</translation>
    </message>
    <message>
        <source>passed</source>
        <translation>合格</translation>
    </message>
    <message>
        <source>failed</source>
        <translation>不合格</translation>
    </message>
    <message>
        <source>not applicable</source>
        <translation>不适用</translation>
    </message>
    <message>
        <source>Horizon</source>
        <translation>层面</translation>
    </message>
    <message>
        <source>Check of the file</source>
        <translation>文件检查项</translation>
    </message>
    <message>
        <source>Result</source>
        <translation>结果</translation>
    </message>
    <message>
        <source>Found</source>
        <translation>实测</translation>
    </message>
    <message>
        <source>Limit</source>
        <translation>限值</translation>
    </message>
    <message>
        <source>In words</source>
        <translation>说明</translation>
    </message>
</context>
<context>
    <name>Files</name>
    <message>
        <source>Open a project or a site file</source>
        <translation>打开工程或场地文件</translation>
    </message>
    <message>
        <source>Projects and site files (*.geofit *.toml);;All files (*)</source>
        <translation>工程和场地文件 (*.geofit *.toml);;所有文件 (*)</translation>
    </message>
    <message>
        <source>Files of the new site</source>
        <translation>新场地的文件</translation>
    </message>
    <message>
        <source>Save the project</source>
        <translation>保存工程</translation>
    </message>
    <message>
        <source>geofit projects (*.geofit)</source>
        <translation>geofit 工程 (*.geofit)</translation>
    </message>
    <message>
        <source>Save {name}</source>
        <translation>保存 {name}</translation>
    </message>
    <message>
        <source>Save the changes of {name}?</source>
        <translation>是否保存对 {name} 的更改？</translation>
    </message>
    <message>
        <source>What is not saved is lost.</source>
        <translation>未保存的内容将丢失。</translation>
    </message>
    <message>
        <source>Bring back {name}</source>
        <translation>恢复 {name}</translation>
    </message>
    <message>
        <source>Open {name}</source>
        <translation>打开 {name}</translation>
    </message>
    <message>
        <source>Open sample site</source>
        <translation>打开示例场地</translation>
    </message>
    <message>
        <source>Brought back, {count} steps.</source>
        <translation>已恢复 {count} 步操作。</translation>
    </message>
    <message>
        <source>Read the surfaces of {name}</source>
        <translation>读取 {name} 的曲面</translation>
    </message>
    <message>
        <source>{name}: {horizons} horizons, {errors} rows not used.</source>
        <translation>{name}：{horizons} 个层面，{errors} 行未采用。</translation>
    </message>
    <message>
        <source>Saved {name}.</source>
        <translation>已保存 {name}。</translation>
    </message>
</context>
<context>
    <name>FitPanel</name>
    <message>
        <source>Apply</source>
        <translation>应用</translation>
    </message>
    <message>
        <source>Reset</source>
        <translation>复位</translation>
    </message>
    <message>
        <source>Fit</source>
        <translation>拟合</translation>
    </message>
    <message>
        <source>Fit all</source>
        <translation>全部拟合</translation>
    </message>
    <message>
        <source>Take these settings; the surface stays as it is until it is fitted.</source>
        <translation>采用这些设置；重新拟合之前曲面不变。</translation>
    </message>
    <message>
        <source>Go back to the settings that were applied last.</source>
        <translation>恢复到上次应用的设置。</translation>
    </message>
    <message>
        <source>Apply, and fit this horizon.</source>
        <translation>应用设置并拟合该层面。</translation>
    </message>
    <message>
        <source>Fit every horizon with its own settings.</source>
        <translation>按各自的设置拟合全部层面。</translation>
    </message>
    <message>
        <source>No horizon chosen: choose one in the project tree to see how it is fitted.</source>
        <translation>未选层面：在工程树中选取一个，查看其拟合设置。</translation>
    </message>
    <message>
        <source>Fit of {name}</source>
        <translation>{name} 的拟合</translation>
    </message>
    <message>
        <source>m</source>
        <translation>m</translation>
    </message>
    <message>
        <source>Judged by</source>
        <translation>判定标准</translation>
    </message>
    <message>
        <source>Control error ε</source>
        <translation>控制误差 ε</translation>
    </message>
    <message>
        <source>The surface passes when σ, the standard deviation of all points from it, is below this.</source>
        <translation>全部点到曲面的中误差 σ 小于此值时，曲面合格。</translation>
    </message>
    <message>
        <source>Interior tolerance</source>
        <translation>内部容差</translation>
    </message>
    <message>
        <source>How far a point outside the core may lie from the surface. The fit refines until it holds or nothing more helps.</source>
        <translation>核心区以外的点到曲面的允许距离。拟合不断加密，直到满足或再无改善。</translation>
    </message>
    <message>
        <source>Seam tolerance</source>
        <translation>拼接缝容差</translation>
    </message>
    <message>
        <source>How far the edges of neighbouring patches may gape. Patches of a fit share their edges: no gap.</source>
        <translation>相邻曲面片边界之间允许的缝隙。一次拟合的曲面片共用边界，没有缝隙。</translation>
    </message>
    <message>
        <source>Shape</source>
        <translation>形态</translation>
    </message>
    <message>
        <source>Exact core</source>
        <translation>精确核心区</translation>
    </message>
    <message>
        <source>Automatic</source>
        <translation>自动</translation>
    </message>
    <message>
        <source>All points</source>
        <translation>全部点</translation>
    </message>
    <message>
        <source>None</source>
        <translation>无</translation>
    </message>
    <message>
        <source>Drawn, {n} corners</source>
        <translation>手绘，{n} 个角点</translation>
    </message>
    <message>
        <source>The region whose points the surface meets exactly. Automatic: where the points are dense. All: every point. None: all points are approximated. Drawn: the rectangle around the polygon of the plan.</source>
        <translation>曲面精确通过其中各点的区域。自动：点密集处。全部：所有点。无：所有点均逼近。手绘：平面图中多边形的外接矩形。</translation>
    </message>
    <message>
        <source>Across sections</source>
        <translation>剖面之间</translation>
    </message>
    <message>
        <source>Cubic</source>
        <translation>三次</translation>
    </message>
    <message>
        <source>Linear</source>
        <translation>线性</translation>
    </message>
    <message>
        <source>How the core runs from one section to the next: smoothly, or along straight lines as drawn by hand.</source>
        <translation>核心区在剖面之间的过渡：光滑曲线，或如手绘的直线。</translation>
    </message>
    <message>
        <source>At the seams</source>
        <translation>拼接缝处</translation>
    </message>
    <message>
        <source>Smooth</source>
        <translation>光滑</translation>
    </message>
    <message>
        <source>Break allowed</source>
        <translation>允许转折</translation>
    </message>
    <message>
        <source>Whether neighbouring patches share a tangent plane, or meet at the edge and may break there.</source>
        <translation>相邻曲面片共用切平面，或仅在边界相接、允许转折。</translation>
    </message>
    <message>
        <source>Laid over</source>
        <translation>参数域</translation>
    </message>
    <message>
        <source>The map</source>
        <translation>水平面</translation>
    </message>
    <message>
        <source>Its best plane</source>
        <translation>最佳平面</translation>
    </message>
    <message>
        <source>Its sections</source>
        <translation>剖面线</translation>
    </message>
    <message>
        <source>Map: one height at each place. Best plane: for steep faults. Sections: for overturned folds, through the section lines in order.</source>
        <translation>水平面：每处一个高程。最佳平面：适于陡倾断层。剖面线：适于倒转褶皱，按顺序穿过各剖面线。</translation>
    </message>
    <message>
        <source>Fixed</source>
        <translation>固定</translation>
    </message>
    <message>
        <source>At most</source>
        <translation>最多</translation>
    </message>
    <message>
        <source>Smoothing</source>
        <translation>光滑系数</translation>
    </message>
    <message>
        <source>Weight of the bending energy outside the core. Automatic: from the scatter of the points. Larger is smoother, smaller is nearer to the points.</source>
        <translation>核心区以外弯曲能的权。自动：由点的离散程度确定。越大越光滑，越小越贴近各点。</translation>
    </message>
    <message>
        <source>Outliers</source>
        <translation>离群点</translation>
    </message>
    <message>
        <source>Fitted too</source>
        <translation>参与拟合</translation>
    </message>
    <message>
        <source>Left out</source>
        <translation>不参与</translation>
    </message>
    <message>
        <source>Peripheral points that their neighbours do not bear out. They are named and count in sigma either way.</source>
        <translation>与相邻点不符的外围区点。无论是否参与拟合，均列出并计入 σ。</translation>
    </message>
    <message>
        <source>Rounds, at most</source>
        <translation>最多轮数</translation>
    </message>
    <message>
        <source>How often the fit may refine and adjust before it stops and says what is not met.</source>
        <translation>拟合加密与调整的最多次数，之后停止并说明未满足之处。</translation>
    </message>
    <message>
        <source>Control points</source>
        <translation>控制点</translation>
    </message>
    <message>
        <source>Limit of the surface&apos;s size. Automatic: ten a point, at least 400 and at most 60 000.</source>
        <translation>曲面规模的上限。自动：每个数据点 10 个，至少 400，至多 60 000。</translation>
    </message>
    <message>
        <source>One place within</source>
        <translation>重合判定距离</translation>
    </message>
    <message>
        <source>Points nearer to each other in plan than this count as one place. If their elevations differ, the more accurate is kept and the other listed.</source>
        <translation>平面距离小于此值的点视为同一位置。高程不同时保留精度较高者，另一个列出。</translation>
    </message>
    <message>
        <source>Write the decimal mark as a point: 0.5, not 0,5.</source>
        <translation>小数点请用“.”：0.5，不用 0,5。</translation>
    </message>
    <message>
        <source>Not applied yet: press Apply or Fit.</source>
        <translation>尚未应用：点“应用”或“拟合”。</translation>
    </message>
    <message>
        <source>The surface is older than these settings: press Fit.</source>
        <translation>曲面早于当前设置：请点“拟合”。</translation>
    </message>
</context>
<context>
    <name>Fitting</name>
    <message>
        <source>Fit {name}</source>
        <translation>拟合 {name}</translation>
    </message>
    <message>
        <source>Part {name} at its faults</source>
        <translation>沿断层划分 {name}</translation>
    </message>
    <message>
        <source>Measure the throw of {name}</source>
        <translation>量测 {name} 的落差</translation>
    </message>
    <message>
        <source>Examine {name} off its data</source>
        <translation>检验 {name} 数据点以外的误差</translation>
    </message>
    <message>
        <source>Make {name} again</source>
        <translation>重新生成 {name}</translation>
    </message>
</context>
<context>
    <name>Help</name>
    <message>
        <source>The way through geofit</source>
        <extracomment>The page of the tutorial in a checkout; an installed package has the short form below.</extracomment>
        <translation>geofit 使用步骤</translation>
    </message>
    <message>
        <source>&lt;ol&gt;&lt;li&gt;Open the sample site, a project, or drop your tables on the window.&lt;/li&gt;&lt;li&gt;Choose a horizon in the project tree; its plan shows the dense core that is interpolated.&lt;/li&gt;&lt;li&gt;Press Fit (F5). The badge says PASS when σ is below ε.&lt;/li&gt;&lt;li&gt;Go to the worst point (F8): its hole, file and row are shown. Exclude it, or adjust by hand.&lt;/li&gt;&lt;li&gt;Examine off the data (F6) to see how far the rock may lie elsewhere.&lt;/li&gt;&lt;li&gt;Export STEP (Ctrl+E); write the report (Ctrl+R).&lt;/li&gt;&lt;/ol&gt;</source>
        <translation>&lt;ol&gt;&lt;li&gt;打开示例场地或工程，或将您的表格拖到窗口上。&lt;/li&gt;&lt;li&gt;在工程树中选取层面；平面图显示精确插值的密集核心区。&lt;/li&gt;&lt;li&gt;点“拟合”（F5）。σ 小于 ε 时标为“合格”。&lt;/li&gt;&lt;li&gt;转到残差最大点（F8）：显示其钻孔、文件和行号。可剔除该行，或手工调整。&lt;/li&gt;&lt;li&gt;检验数据点以外（F6），了解无数据处岩层可能偏离多少。&lt;/li&gt;&lt;li&gt;导出 STEP（Ctrl+E）；编写报告（Ctrl+R）。&lt;/li&gt;&lt;/ol&gt;</translation>
    </message>
    <message>
        <source>About geofit</source>
        <translation>关于 geofit</translation>
    </message>
    <message>
        <source>&lt;h3&gt;geofit {version}&lt;/h3&gt;&lt;p&gt;NURBS surfaces of geological horizons: fitted, checked against a tolerance, stitched, written as STEP.&lt;/p&gt;&lt;p&gt;Apache-2.0. Windows by Qt (LGPL-3), 3D by VTK (BSD-3), solids by OpenCASCADE (LGPL-2.1 with exception).&lt;/p&gt;</source>
        <translation>&lt;h3&gt;geofit {version}&lt;/h3&gt;&lt;p&gt;地质层面的 NURBS 曲面：拟合、按容差检验、拼接、写出 STEP。&lt;/p&gt;&lt;p&gt;Apache-2.0。窗口：Qt（LGPL-3）；三维：VTK（BSD-3）；实体：OpenCASCADE（LGPL-2.1 及例外条款）。&lt;/p&gt;</translation>
    </message>
</context>
<context>
    <name>HistogramPanel</name>
    <message>
        <source>Histogram and normal plot of the residuals</source>
        <extracomment>Room beside a picture for its scale, logical pixels. Letters of the legend in points, and the height of its lines, logical pixels.</extracomment>
        <translation>残差直方图与正态概率图</translation>
    </message>
    <message>
        <source>No surface yet: press Fit to see how its residuals are spread.</source>
        <translation>尚无曲面：点“拟合”后显示残差分布。</translation>
    </message>
    <message>
        <source>Every point is met exactly: there is no residual to count.</source>
        <translation>全部点均被精确通过，无残差可统计。</translation>
    </message>
</context>
<context>
    <name>ImportWizard</name>
    <message>
        <source>Import</source>
        <extracomment>Tables that are named where many are to be settled.</extracomment>
        <translation>导入</translation>
    </message>
    <message>
        <source>Tables</source>
        <extracomment>Files that this wizard wrote where there were none.</extracomment>
        <translation>数据表</translation>
    </message>
    <message>
        <source>&amp;Add files…</source>
        <translation>添加文件(&amp;A)...</translation>
    </message>
    <message>
        <source>Re&amp;move</source>
        <translation>移除(&amp;M)</translation>
    </message>
    <message>
        <source>Coordinate system of the site. Longitude and latitude are projected to it.</source>
        <translation>场地的坐标系。经纬度将投影到该坐标系。</translation>
    </message>
    <message>
        <source>&amp;Back</source>
        <translation>上一步(&amp;B)</translation>
    </message>
    <message>
        <source>Site &amp;file</source>
        <translation>场地文件(&amp;F)</translation>
    </message>
    <message>
        <source>The site is written; Cancel takes it away again.</source>
        <translation>场地已写出；点“取消”将其删除。</translation>
    </message>
    <message>
        <source>Every table is left out: there is nothing to read.</source>
        <translation>全部表格均不导入：没有可读取的内容。</translation>
    </message>
    <message>
        <source>{name} is there already, and will be written over.</source>
        <translation>{name} 已存在，将被覆盖。</translation>
    </message>
    <message>
        <source>Ready. Tables that will be read: {count}.</source>
        <translation>就绪。将读取 {count} 个表。</translation>
    </message>
    <message>
        <source>Add files</source>
        <translation>添加文件</translation>
    </message>
    <message>
        <source>&amp;Open site</source>
        <translation>打开场地(&amp;O)</translation>
    </message>
    <message>
        <source>&amp;Read</source>
        <translation>读入(&amp;R)</translation>
    </message>
    <message>
        <source>Bro&amp;wse…</source>
        <translation>浏览(&amp;W)...</translation>
    </message>
    <message>
        <source>Coordinate s&amp;ystem</source>
        <translation>坐标系(&amp;Y)</translation>
    </message>
    <message>
        <source>To be settled: {names}</source>
        <translation>待确认：{names}</translation>
    </message>
    <message>
        <source>Add files, or drop them here.</source>
        <translation>请添加文件，或将文件拖到此处。</translation>
    </message>
    <message>
        <source>Site files (*.toml)</source>
        <translation>场地文件 (*.toml)</translation>
    </message>
    <message>
        <source>Reading the files…</source>
        <translation>正在读取文件…</translation>
    </message>
    <message>
        <source>Stopped.</source>
        <translation>已停止。</translation>
    </message>
</context>
<context>
    <name>IssuesDialog</name>
    <message>
        <source>Import problems</source>
        <translation>导入问题</translation>
    </message>
    <message>
        <source>Rows read: {read} = {used} used + {listed} listed here.</source>
        <translation>读入 {read} 行 = 采用 {used} 行 + 此处列出 {listed} 行。</translation>
    </message>
    <message>
        <source>&amp;Export CSV…</source>
        <translation>导出 CSV(&amp;E)...</translation>
    </message>
</context>
<context>
    <name>Kind</name>
    <message>
        <source>Collars</source>
        <translation>孔口表</translation>
    </message>
    <message>
        <source>Downhole survey</source>
        <translation>测斜表</translation>
    </message>
    <message>
        <source>Intervals (log)</source>
        <translation>分层表（编录）</translation>
    </message>
    <message>
        <source>Adit paths</source>
        <translation>平硐轴线</translation>
    </message>
    <message>
        <source>Contacts in adits</source>
        <translation>平硐揭露点</translation>
    </message>
    <message>
        <source>One section</source>
        <translation>单个剖面</translation>
    </message>
    <message>
        <source>Several sections</source>
        <translation>多个剖面</translation>
    </message>
    <message>
        <source>Section lines in plan</source>
        <translation>剖面线平面位置</translation>
    </message>
    <message>
        <source>Map traces</source>
        <translation>地质界线</translation>
    </message>
    <message>
        <source>Points (picks)</source>
        <translation>层面点</translation>
    </message>
    <message>
        <source>One column a horizon</source>
        <translation>每列一个层面</translation>
    </message>
    <message>
        <source>Measured dips</source>
        <translation>实测产状</translation>
    </message>
    <message>
        <source>Study area</source>
        <translation>研究区范围</translation>
    </message>
    <message>
        <source>Ground surface (grid)</source>
        <translation>地面（格网）</translation>
    </message>
    <message>
        <source>Horizon (grid)</source>
        <translation>层面（格网）</translation>
    </message>
    <message>
        <source>Section drawing</source>
        <translation>剖面图</translation>
    </message>
    <message>
        <source>Leave out</source>
        <translation>不导入</translation>
    </message>
    <message>
        <source>Not recognised</source>
        <translation>未识别</translation>
    </message>
</context>
<context>
    <name>LogPanel</name>
    <message>
        <source>Log</source>
        <extracomment>Lines kept.</extracomment>
        <translation>日志</translation>
    </message>
    <message>
        <source>Nothing to tell yet: what geofit does is written here.</source>
        <translation>暂无记录：geofit 的操作记录在此。</translation>
    </message>
    <message>
        <source>Copy all</source>
        <translation>全部复制</translation>
    </message>
    <message>
        <source>Clear</source>
        <translation>清空</translation>
    </message>
    <message>
        <source>warning</source>
        <translation>警告</translation>
    </message>
    <message>
        <source>error</source>
        <translation>错误</translation>
    </message>
</context>
<context>
    <name>MainWindow</name>
    <message>
        <source>Section</source>
        <extracomment>Actions that need no open site.</extracomment>
        <translation>剖面</translation>
    </message>
    <message>
        <source>Drawing</source>
        <translation>绘图</translation>
    </message>
    <message>
        <source>Rename site</source>
        <translation>重命名场地</translation>
    </message>
    <message>
        <source>Name of the site</source>
        <translation>场地名称</translation>
    </message>
</context>
<context>
    <name>Menus</name>
    <message>
        <source>&amp;Undo</source>
        <translation>撤销(&amp;U)</translation>
    </message>
    <message>
        <source>&amp;Redo</source>
        <translation>重做(&amp;R)</translation>
    </message>
    <message>
        <source>&amp;File</source>
        <extracomment>Actions of the tool bar, a bar between groups.</extracomment>
        <translation>文件(&amp;F)</translation>
    </message>
    <message>
        <source>Open &amp;recent</source>
        <translation>最近打开(&amp;R)</translation>
    </message>
    <message>
        <source>&amp;Edit</source>
        <translation>编辑(&amp;E)</translation>
    </message>
    <message>
        <source>&amp;View</source>
        <translation>视图(&amp;V)</translation>
    </message>
    <message>
        <source>Vertical e&amp;xaggeration</source>
        <translation>竖向放大(&amp;X)</translation>
    </message>
    <message>
        <source>&amp;Panels</source>
        <translation>面板(&amp;P)</translation>
    </message>
    <message>
        <source>T&amp;heme</source>
        <translation>主题(&amp;H)</translation>
    </message>
    <message>
        <source>&amp;Language</source>
        <translation>语言(&amp;L)</translation>
    </message>
    <message>
        <source>Hori&amp;zon</source>
        <translation>层面(&amp;Z)</translation>
    </message>
    <message>
        <source>&amp;Tools</source>
        <translation>工具(&amp;T)</translation>
    </message>
    <message>
        <source>&amp;Help</source>
        <translation>帮助(&amp;H)</translation>
    </message>
    <message>
        <source>&amp;Undo {step}</source>
        <translation>撤销 {step}(&amp;U)</translation>
    </message>
    <message>
        <source>&amp;Redo {step}</source>
        <translation>重做 {step}(&amp;R)</translation>
    </message>
    <message>
        <source>Tool bar</source>
        <translation>工具栏</translation>
    </message>
</context>
<context>
    <name>OffDataPanel</name>
    <message>
        <source>Examine again</source>
        <extracomment>Rows of a table before it scrolls.</extracomment>
        <translation>重新检验</translation>
    </message>
    <message>
        <source>Leave out each hole and section in turn, and fit without it.</source>
        <translation>依次留出每个钻孔和剖面，在没有它的情况下拟合。</translation>
    </message>
    <message>
        <source>How sure the surface is</source>
        <translation>曲面的可靠程度</translation>
    </message>
    <message>
        <source>Error where data was left out</source>
        <translation>留出数据处的误差</translation>
    </message>
    <message>
        <source>Where the next holes would tell most</source>
        <translation>建议孔位</translation>
    </message>
    <message>
        <source>Points that their neighbours do not bear out</source>
        <translation>与相邻点不符的点</translation>
    </message>
    <message>
        <source>Notes</source>
        <translation>说明</translation>
    </message>
    <message>
        <source>Not examined yet: how far the rock may lie from the surface where nobody drilled is found by leaving out each hole and section in turn.</source>
        <translation>尚未检验：依次留出每个钻孔和剖面，可得知无勘探处岩层可能偏离曲面多少。</translation>
    </message>
    <message>
        <source>Examine</source>
        <translation>检验</translation>
    </message>
    <message>
        <source>No surface yet: press Fit, then examine it away from the data.</source>
        <translation>尚无曲面：先点“拟合”，再检验数据点以外的误差。</translation>
    </message>
    <message>
        <source>Standard deviation of the surface: {mean:.2f} m on average, {most:.2f} m at most.</source>
        <translation>曲面标准差：平均 {mean:.2f} m，最大 {most:.2f} m。</translation>
    </message>
    <message>
        <source>Widened by a factor of {factor:.2f}, so that 90 % of the left-out points lie in the 90 % band.</source>
        <translation>已乘校准系数 {factor:.2f}，使 90 % 的留出点落在 90 % 置信带内。</translation>
    </message>
    <message>
        <source>Narrowed by a factor of {factor:.2f}: fewer than 10 % of the left-out points lay outside the 90 % band.</source>
        <translation>已乘校准系数 {factor:.2f} 收窄：校准前不足 10 % 的留出点在 90 % 置信带外。</translation>
    </message>
    <message>
        <source>{name}: {inside:.0f} % of the left-out points lie in the 90 % band ({raw:.0f} % before calibration).</source>
        <translation>{name}：留出点有 {inside:.0f} % 落在 90 % 置信带内（校准前 {raw:.0f} %）。</translation>
    </message>
    <message>
        <source>No figure could be found; the notes say why.</source>
        <translation>未能得出数值，原因见说明。</translation>
    </message>
    <message>
        <source>Holes</source>
        <translation>钻孔</translation>
    </message>
    <message>
        <source>Sections</source>
        <translation>剖面</translation>
    </message>
    <message>
        <source>Blocks</source>
        <translation>分块</translation>
    </message>
    <message>
        <source>Thin plate, m</source>
        <translation>薄板样条, m</translation>
    </message>
    <message>
        <source>Kriging, m</source>
        <translation>克里金, m</translation>
    </message>
    <message>
        <source>Root mean square error of another method with the same points left out.</source>
        <translation>另一方法在相同留出点上的均方根误差。</translation>
    </message>
    <message>
        <source>Left out</source>
        <translation>留出方式</translation>
    </message>
    <message>
        <source>geofit, m</source>
        <translation>geofit, m</translation>
    </message>
    <message>
        <source>Root mean square error at the points that were left out.</source>
        <translation>留出点的均方根误差。</translation>
    </message>
    <message>
        <source>In band, %</source>
        <translation>带内, %</translation>
    </message>
    <message>
        <source>Share of the left-out points in the 90 % band.</source>
        <translation>留出点在 90 % 置信带内的比例。</translation>
    </message>
    <message>
        <source>Mean |e|, m</source>
        <translation>平均 |e|, m</translation>
    </message>
    <message>
        <source>Bias, m</source>
        <translation>偏差, m</translation>
    </message>
    <message>
        <source>Largest, m</source>
        <translation>最大, m</translation>
    </message>
    <message>
        <source>Groups</source>
        <translation>组数</translation>
    </message>
    <message>
        <source>No.</source>
        <translation>序号</translation>
    </message>
    <message>
        <source>sd, m</source>
        <translation>标准差, m</translation>
    </message>
    <message>
        <source>Standard deviation there now.</source>
        <translation>该处现有标准差。</translation>
    </message>
    <message>
        <source>Mean after, m</source>
        <translation>补孔后平均, m</translation>
    </message>
    <message>
        <source>Average standard deviation of the surface after this hole and those before it.</source>
        <translation>补打该孔及其前各孔后，曲面的平均标准差。</translation>
    </message>
    <message>
        <source>Most after, m</source>
        <translation>补孔后最大, m</translation>
    </message>
    <message>
        <source>Easting, m</source>
        <translation>东坐标, m</translation>
    </message>
    <message>
        <source>Northing, m</source>
        <translation>北坐标, m</translation>
    </message>
    <message>
        <source>Elevation, m</source>
        <translation>高程, m</translation>
    </message>
    <message>
        <source>Point</source>
        <translation>点</translation>
    </message>
    <message>
        <source>Error, m</source>
        <translation>误差, m</translation>
    </message>
    <message>
        <source>Point minus the surface without it.</source>
        <translation>该点减去不含该点的曲面。</translation>
    </message>
    <message>
        <source>Ratio</source>
        <translation>比值</translation>
    </message>
    <message>
        <source>Error in standard deviations.</source>
        <translation>误差与标准差之比。</translation>
    </message>
</context>
<context>
    <name>OrderDialog</name>
    <message>
        <source>Order of the horizons</source>
        <translation>层面上下次序</translation>
    </message>
    <message>
        <source>The highest first. Drag a horizon to its place, or move it with the buttons.</source>
        <translation>自上而下排列。拖动层面到其位置，或用按钮移动。</translation>
    </message>
    <message>
        <source>&amp;Up</source>
        <translation>上移(&amp;U)</translation>
    </message>
    <message>
        <source>&amp;Down</source>
        <translation>下移(&amp;D)</translation>
    </message>
</context>
<context>
    <name>Ordering</name>
    <message>
        <source>Two fitted horizons are needed to check their order.</source>
        <translation>检查上下次序至少需要两个已拟合的层面。</translation>
    </message>
    <message>
        <source>Check the order</source>
        <translation>检查上下次序</translation>
    </message>
    <message>
        <source>Push horizons apart</source>
        <translation>推开相交层面</translation>
    </message>
    <message>
        <source>Least thickness between a horizon and the next, metres</source>
        <translation>相邻层面之间的最小厚度，m</translation>
    </message>
    <message>
        <source>Cut by a fault, so not pushed apart from others: {names}</source>
        <translation>被断层切割，未与其他层面推开：{names}</translation>
    </message>
    <message>
        <source>&apos;{name}&apos; was read from a file and not fitted here. Fit it again, then push apart.</source>
        <translation>“{name}”读自文件，并非在此拟合。请先重新拟合，再推开。</translation>
    </message>
    <message>
        <source>Two fitted horizons are needed to push them apart. Press Fit all first.</source>
        <translation>推开层面至少需要两个已拟合的层面。请先点“全部拟合”。</translation>
    </message>
    <message>
        <source>{count} of {all} pairs of horizons cross; see Checks.</source>
        <translation>{all} 对层面中有 {count} 对相交，见“检查”。</translation>
    </message>
    <message>
        <source>No two horizons cross.</source>
        <translation>各层面互不相交。</translation>
    </message>
    <message>
        <source>A surface changed meanwhile. Push the horizons apart once more.</source>
        <translation>期间有曲面发生变化。请再次推开层面。</translation>
    </message>
    <message>
        <source>No horizon had to move.</source>
        <translation>无需移动任何层面。</translation>
    </message>
    <message>
        <source>Moved at most: {moved}. Contradictions that stay: {count}.</source>
        <translation>最大移动量：{moved}。尚存矛盾：{count} 处。</translation>
    </message>
</context>
<context>
    <name>PlanPanel</name>
    <message>
        <source>Plan with the core&apos;s rectangle</source>
        <extracomment>Width of words and tools beside the plan, and the most that Qt gives a widget, pixels.</extracomment>
        <translation>平面图与核心区矩形</translation>
    </message>
    <message>
        <source>Auto</source>
        <translation>自动</translation>
    </message>
    <message>
        <source>Let the fit find the dense core.</source>
        <translation>由拟合自动寻找密集核心区。</translation>
    </message>
    <message>
        <source>All</source>
        <translation>全部</translation>
    </message>
    <message>
        <source>Meet every point exactly.</source>
        <translation>精确通过每个点。</translation>
    </message>
    <message>
        <source>None</source>
        <translation>无</translation>
    </message>
    <message>
        <source>Approximate all points.</source>
        <translation>逼近全部点。</translation>
    </message>
    <message>
        <source>Draw</source>
        <translation>绘制</translation>
    </message>
    <message>
        <source>Draw a new rectangle: press and drag in the plan.</source>
        <translation>绘制新矩形：在平面图中按住并拖动。</translation>
    </message>
    <message>
        <source>Undo drag</source>
        <translation>撤销拖动</translation>
    </message>
    <message>
        <source>Take back the last drag that was not used yet.</source>
        <translation>撤销上一次尚未采用的拖动。</translation>
    </message>
    <message>
        <source>Use</source>
        <translation>采用</translation>
    </message>
    <message>
        <source>Make the rectangle the core of the next fit.</source>
        <translation>以该矩形作为下次拟合的核心区。</translation>
    </message>
    <message>
        <source>No horizon chosen: choose one in the project tree to see its plan.</source>
        <translation>未选层面：在工程树中选取一个，查看其平面图。</translation>
    </message>
    <message>
        <source>Not fitted yet: the core is found when the horizon is fitted.</source>
        <translation>尚未拟合：拟合时自动确定核心区。</translation>
    </message>
    <message>
        <source>A rectangle can be drawn only for a surface that is laid over the map.</source>
        <translation>只有以水平面为参数域的曲面才能绘制矩形。</translation>
    </message>
    <message>
        <source>Press and drag in the plan to draw the core&apos;s rectangle.</source>
        <translation>在平面图中按住并拖动，绘制核心区矩形。</translation>
    </message>
    <message>
        <source>{width:.0f} m × {height:.0f} m: {inside} points inside, {outside} outside.</source>
        <translation>{width:.0f} m × {height:.0f} m：区内 {inside} 点，区外 {outside} 点。</translation>
    </message>
    <message>
        <source>The fit widens it to the edge of the area, where next to nothing lies between.</source>
        <translation>若其与区界之间几乎无点，拟合时将扩展到区界。</translation>
    </message>
    <message>
        <source>Press Use to take it.</source>
        <translation>点“采用”生效。</translation>
    </message>
</context>
<context>
    <name>PlanView</name>
    <message>
        <source>exact ({n})</source>
        <extracomment>Colour of the points that are approximated; they are rings, the core&apos;s are discs. More points than this are painted as dots of an image, exact or not. Side of a handle, and how near to it the pointer must be, pixels.</extracomment>
        <translation>精确（{n}）</translation>
    </message>
    <message>
        <source>approximated ({n})</source>
        <translation>逼近（{n}）</translation>
    </message>
</context>
<context>
    <name>Pointer</name>
    <message>
        <source>{distance} m
horizontal {flat} m · Δz {rise} m
azimuth {azimuth}° · dip {dip}°</source>
        <extracomment>The pointer&apos;s place is found at most so often, milliseconds.</extracomment>
        <translation>{distance} m
平距 {flat} m · 高差 {rise} m
方位角 {azimuth}° · 倾角 {dip}°</translation>
    </message>
</context>
<context>
    <name>PreferencesDialog</name>
    <message>
        <source>Preferences</source>
        <translation>首选项</translation>
    </message>
    <message>
        <source>As the system</source>
        <translation>跟随系统</translation>
    </message>
    <message>
        <source>Light</source>
        <translation>浅色</translation>
    </message>
    <message>
        <source>Dark</source>
        <translation>深色</translation>
    </message>
    <message>
        <source>&amp;Theme</source>
        <translation>主题(&amp;T)</translation>
    </message>
    <message>
        <source>&amp;Language</source>
        <translation>语言(&amp;L)</translation>
    </message>
    <message>
        <source>No font on this machine has Chinese characters: they would be boxes. Install one (Debian and Ubuntu: apt-get install fonts-noto-cjk) and start again.</source>
        <translation>本机没有中文字体，汉字将显示为方框。请安装中文字体（Debian 和 Ubuntu：apt-get install fonts-noto-cjk）后重新启动。</translation>
    </message>
</context>
<context>
    <name>ProjectTree</name>
    <message>
        <source>Filter by name</source>
        <translation>按名称筛选</translation>
    </message>
    <message>
        <source>Filter of the project tree</source>
        <translation>工程树筛选</translation>
    </message>
    <message>
        <source>Project tree</source>
        <translation>工程树</translation>
    </message>
    <message>
        <source>No site open: open a site or a project, or drop its files on the window.</source>
        <translation>未打开场地：请打开场地或工程，或将文件拖到窗口上。</translation>
    </message>
    <message>
        <source>Project</source>
        <translation>工程</translation>
    </message>
    <message>
        <source>Points</source>
        <translation>点数</translation>
    </message>
    <message>
        <source>Horizons</source>
        <translation>层面</translation>
    </message>
    <message>
        <source>Boreholes</source>
        <translation>钻孔</translation>
    </message>
    <message>
        <source>Adits</source>
        <translation>平硐</translation>
    </message>
    <message>
        <source>Sections</source>
        <translation>剖面</translation>
    </message>
    <message>
        <source>Reports</source>
        <translation>报告</translation>
    </message>
    <message>
        <source>{name}: not fitted yet</source>
        <translation>{name}：尚未拟合</translation>
    </message>
    <message>
        <source>PASS</source>
        <translation>合格</translation>
    </message>
    <message>
        <source>FAIL</source>
        <translation>不合格</translation>
    </message>
    <message>
        <source>{name}: {verdict}, σ {sigma} m, ε {epsilon} m; patches: {patches}, points: {n}</source>
        <translation>{name}：{verdict}，σ {sigma} m，ε {epsilon} m；曲面片 {patches} 个，点 {n} 个</translation>
    </message>
    <message>
        <source>{name} (stale)</source>
        <translation>{name}（已过时）</translation>
    </message>
    <message>
        <source>Older than the settings: press Fit</source>
        <translation>早于当前设置：请点“拟合”</translation>
    </message>
    <message>
        <source>Patch {name}: {rows} × {columns} control points, largest |d| {most} m</source>
        <translation>曲面片 {name}：{rows} × {columns} 个控制点，最大 |d| {most} m</translation>
    </message>
    <message>
        <source>{title} ({n})</source>
        <translation>{title}（{n}）</translation>
    </message>
</context>
<context>
    <name>RecoveryDialog</name>
    <message>
        <source>Bring back unsaved work</source>
        <extracomment>Steps of a session that its entry names.</extracomment>
        <translation>恢复未保存的工作</translation>
    </message>
    <message>
        <source>geofit did not end as it should. This work was not saved:</source>
        <translation>geofit 上次未正常退出。以下工作尚未保存：</translation>
    </message>
    <message>
        <source>&amp;Bring back</source>
        <translation>恢复(&amp;B)</translation>
    </message>
    <message>
        <source>&amp;Discard all</source>
        <translation>全部放弃(&amp;D)</translation>
    </message>
    <message>
        <source>Ask me &amp;later</source>
        <translation>以后再问(&amp;L)</translation>
    </message>
    <message>
        <source>{site} – {when} – steps ({count}): {steps}
{file}</source>
        <translation>{site} – {when} – {count} 步：{steps}
{file}</translation>
    </message>
</context>
<context>
    <name>ReportDialog</name>
    <message>
        <source>Accuracy report</source>
        <translation>精度检验报告</translation>
    </message>
    <message>
        <source>&amp;HTML, one file with its pictures</source>
        <translation>&amp;HTML，单个文件，含图</translation>
    </message>
    <message>
        <source>&amp;PDF, A4, with its fonts</source>
        <translation>&amp;PDF，A4，内嵌字体</translation>
    </message>
    <message>
        <source>&amp;JSON, every figure for machines</source>
        <translation>&amp;JSON，全部数据，供程序读取</translation>
    </message>
    <message>
        <source>Horizons: {names}</source>
        <translation>层面：{names}</translation>
    </message>
    <message>
        <source>&amp;Examine first: {names}</source>
        <translation>先检验(&amp;E)：{names}</translation>
    </message>
    <message>
        <source>How far the rock may lie from the surface where nobody drilled, found by leaving out holes.</source>
        <translation>用留出钻孔的方法，求无勘探处岩层可能偏离曲面多少。</translation>
    </message>
    <message>
        <source>&amp;Write</source>
        <translation>写出(&amp;W)</translation>
    </message>
    <message>
        <source>&amp;Open</source>
        <translation>打开(&amp;O)</translation>
    </message>
    <message>
        <source>&amp;Browse…</source>
        <translation>浏览(&amp;B)...</translation>
    </message>
    <message>
        <source>Site</source>
        <translation>场地</translation>
    </message>
    <message>
        <source>&amp;Language</source>
        <translation>语言(&amp;L)</translation>
    </message>
    <message>
        <source>Forms</source>
        <translation>格式</translation>
    </message>
    <message>
        <source>&amp;Date</source>
        <translation>日期(&amp;D)</translation>
    </message>
    <message>
        <source>&amp;Folder</source>
        <translation>文件夹(&amp;F)</translation>
    </message>
    <message>
        <source>Off the data</source>
        <translation>数据点以外</translation>
    </message>
    <message>
        <source>Writing the report…</source>
        <translation>正在编写报告……</translation>
    </message>
    <message>
        <source>Stopped. No report was written.</source>
        <translation>已停止，未写出报告。</translation>
    </message>
    <message>
        <source>Wrote {names} in {folder}.</source>
        <translation>已写出 {names}，位于 {folder}。</translation>
    </message>
</context>
<context>
    <name>ResidualTable</name>
    <message>
        <source>Filter by hole, section, kind, patch or file</source>
        <translation>按钻孔、剖面、来源、曲面片或文件筛选</translation>
    </message>
    <message>
        <source>Filter of the residual table</source>
        <translation>残差表筛选</translation>
    </message>
    <message>
        <source>Over tolerance</source>
        <translation>仅超限</translation>
    </message>
    <message>
        <source>Not exact</source>
        <translation>仅非精确点</translation>
    </message>
    <message>
        <source>Leave out the core&apos;s points, which the surface meets exactly.</source>
        <translation>不显示核心区中曲面精确通过的点。</translation>
    </message>
    <message>
        <source>Residuals of all points</source>
        <translation>全部点的残差</translation>
    </message>
    <message>
        <source>This surface came without points: there are no residuals.</source>
        <translation>该曲面没有数据点，因此没有残差。</translation>
    </message>
    <message>
        <source>No surface yet: press Fit to see how far each point lies from it.</source>
        <translation>尚无曲面：点“拟合”后显示每个点到曲面的距离。</translation>
    </message>
    <message>
        <source>Only points further from the surface than the interior tolerance, {limit:g} m.</source>
        <translation>只显示到曲面的距离大于内部容差 {limit:g} m 的点。</translation>
    </message>
    <message>
        <source>The picked point is hidden by the filter</source>
        <translation>所选的点被筛选隐藏</translation>
    </message>
    <message>
        <source>exact</source>
        <translation>精确</translation>
    </message>
    <message>
        <source>Residual, m</source>
        <translation>残差, m</translation>
    </message>
    <message>
        <source>Signed orthogonal distance: positive above the surface.</source>
        <translation>带符号的正交距离：点在曲面之上为正。</translation>
    </message>
    <message>
        <source>|d|, m</source>
        <translation>|d|, m</translation>
    </message>
    <message>
        <source>Distance without its sign.</source>
        <translation>距离的绝对值。</translation>
    </message>
    <message>
        <source>Kind</source>
        <translation>来源</translation>
    </message>
    <message>
        <source>Hole</source>
        <translation>钻孔</translation>
    </message>
    <message>
        <source>Section</source>
        <translation>剖面</translation>
    </message>
    <message>
        <source>Patch</source>
        <translation>曲面片</translation>
    </message>
    <message>
        <source>Core</source>
        <translation>核心区</translation>
    </message>
    <message>
        <source>Whether the surface meets the point exactly.</source>
        <translation>曲面是否精确通过该点。</translation>
    </message>
    <message>
        <source>Easting, m</source>
        <translation>东坐标, m</translation>
    </message>
    <message>
        <source>Northing, m</source>
        <translation>北坐标, m</translation>
    </message>
    <message>
        <source>Elevation, m</source>
        <translation>高程, m</translation>
    </message>
    <message>
        <source>File</source>
        <translation>文件</translation>
    </message>
    <message>
        <source>Row</source>
        <translation>行</translation>
    </message>
    <message>
        <source>Line of the file, counted from 1.</source>
        <translation>文件中的行号，从 1 起。</translation>
    </message>
    <message>
        <source>Note</source>
        <translation>备注</translation>
    </message>
    <message>
        <source>Points: {n}</source>
        <translation>共 {n} 点</translation>
    </message>
    <message>
        <source>Points: {shown} of {n}</source>
        <translation>显示 {shown} / {n} 点</translation>
    </message>
</context>
<context>
    <name>ResultPage</name>
    <message>
        <source>Show &amp;notes (guesses that were made)</source>
        <extracomment>Widest column of reasons: what to do about them must be seen beside it.</extracomment>
        <translation>显示识别说明(&amp;N)</translation>
    </message>
    <message>
        <source>&amp;Export problems…</source>
        <translation>导出问题(&amp;E)...</translation>
    </message>
    <message>
        <source>Horizons</source>
        <translation>层面</translation>
    </message>
    <message>
        <source>Files</source>
        <translation>文件</translation>
    </message>
    <message>
        <source>Problems</source>
        <translation>问题</translation>
    </message>
    <message>
        <source>{read} rows read = {used} used + {listed} listed below.</source>
        <translation>读入 {read} 行 = 采用 {used} 行 + 下列 {listed} 行。</translation>
    </message>
    <message>
        <source>No horizon was found: go back, and add intervals, sections, traces or points.</source>
        <translation>未找到层面：请返回上一步，添加分层表、剖面、地质界线或层面点。</translation>
    </message>
    <message>
        <source>Horizon</source>
        <translation>层面</translation>
    </message>
    <message>
        <source>Points</source>
        <translation>点数</translation>
    </message>
    <message>
        <source>File</source>
        <translation>文件</translation>
    </message>
    <message>
        <source>Rows</source>
        <translation>行数</translation>
    </message>
    <message>
        <source>Used</source>
        <translation>采用</translation>
    </message>
    <message>
        <source>Listed</source>
        <translation>列出</translation>
    </message>
    <message>
        <source>not used</source>
        <translation>未采用</translation>
    </message>
    <message>
        <source>look</source>
        <translation>请复核</translation>
    </message>
    <message>
        <source>note</source>
        <translation>说明</translation>
    </message>
    <message>
        <source>Kind</source>
        <translation>类别</translation>
    </message>
    <message>
        <source>Row</source>
        <translation>行</translation>
    </message>
    <message>
        <source>Column</source>
        <translation>列</translation>
    </message>
    <message>
        <source>Value</source>
        <translation>数值</translation>
    </message>
    <message>
        <source>Reason</source>
        <translation>原因</translation>
    </message>
    <message>
        <source>What to do</source>
        <translation>处理方法</translation>
    </message>
    <message>
        <source>Show &amp;notes ({count} guesses that were made)</source>
        <translation>显示识别说明（{count} 条）(&amp;N)</translation>
    </message>
</context>
<context>
    <name>Role</name>
    <message>
        <source>Hole</source>
        <translation>钻孔</translation>
    </message>
    <message>
        <source>Easting</source>
        <translation>东坐标</translation>
    </message>
    <message>
        <source>Northing</source>
        <translation>北坐标</translation>
    </message>
    <message>
        <source>Elevation</source>
        <translation>高程</translation>
    </message>
    <message>
        <source>Depth</source>
        <translation>深度</translation>
    </message>
    <message>
        <source>Azimuth</source>
        <translation>方位角</translation>
    </message>
    <message>
        <source>Dip</source>
        <translation>倾角</translation>
    </message>
    <message>
        <source>Strike</source>
        <translation>走向</translation>
    </message>
    <message>
        <source>From</source>
        <translation>起始深度</translation>
    </message>
    <message>
        <source>To</source>
        <translation>终止深度</translation>
    </message>
    <message>
        <source>Stratum code</source>
        <translation>地层代号</translation>
    </message>
    <message>
        <source>Adit</source>
        <translation>平硐</translation>
    </message>
    <message>
        <source>Chainage</source>
        <translation>硐深</translation>
    </message>
    <message>
        <source>Horizon</source>
        <translation>层面</translation>
    </message>
    <message>
        <source>Horizon elevation</source>
        <translation>层面高程</translation>
    </message>
    <message>
        <source>Horizon depth</source>
        <translation>层面深度</translation>
    </message>
    <message>
        <source>Distance along</source>
        <translation>沿线距离</translation>
    </message>
    <message>
        <source>Section</source>
        <translation>剖面</translation>
    </message>
    <message>
        <source>Source kind</source>
        <translation>资料来源</translation>
    </message>
    <message>
        <source>Accuracy</source>
        <translation>精度</translation>
    </message>
    <message>
        <source>Easting, start</source>
        <translation>起点东坐标</translation>
    </message>
    <message>
        <source>Northing, start</source>
        <translation>起点北坐标</translation>
    </message>
    <message>
        <source>Easting, end</source>
        <translation>终点东坐标</translation>
    </message>
    <message>
        <source>Northing, end</source>
        <translation>终点北坐标</translation>
    </message>
    <message>
        <source>Normal, east</source>
        <translation>法向东分量</translation>
    </message>
    <message>
        <source>Normal, north</source>
        <translation>法向北分量</translation>
    </message>
    <message>
        <source>Normal, up</source>
        <translation>法向竖分量</translation>
    </message>
</context>
<context>
    <name>Said</name>
    <message>
        <source>Settings of {name}</source>
        <translation>{name} 的设置</translation>
    </message>
    <message>
        <source>Core of {name}</source>
        <translation>{name} 的核心区</translation>
    </message>
    <message>
        <source>Exclude {file} row {row} from {name}</source>
        <translation>从 {name} 剔除 {file} 第 {row} 行</translation>
    </message>
    <message>
        <source>Include {file} row {row} in {name}</source>
        <translation>将 {file} 第 {row} 行恢复到 {name}</translation>
    </message>
    <message>
        <source>Fit {name}</source>
        <translation>拟合 {name}</translation>
    </message>
    <message>
        <source>Part {name} at {faults}</source>
        <translation>沿 {faults} 划分 {name}</translation>
    </message>
    <message>
        <source>Move control point {i}, {j} of {patch} by {dz:+.3f} m ({name})</source>
        <translation>{name}：{patch} 的控制点 {i}, {j} 移动 {dz:+.3f} m</translation>
    </message>
    <message>
        <source>Weight {weight:g} for control point {i}, {j} of {patch} ({name})</source>
        <translation>{name}：{patch} 的控制点 {i}, {j} 的权设为 {weight:g}</translation>
    </message>
    <message>
        <source>Pull {name} to point {number}</source>
        <translation>将 {name} 拉近到第 {number} 点</translation>
    </message>
    <message>
        <source>Push apart {names}</source>
        <translation>推开 {names}</translation>
    </message>
    <message>
        <source>Order of the horizons</source>
        <translation>层面上下次序</translation>
    </message>
    <message>
        <source>Rename the site to {name}</source>
        <translation>场地重命名为 {name}</translation>
    </message>
    <message>
        <source>The site has no horizon &apos;{name}&apos;. It has {names}.</source>
        <translation>场地没有层面“{name}”；现有：{names}。</translation>
    </message>
    <message>
        <source>&apos;{step}&apos; was not done yet and cannot be undone.</source>
        <translation>“{step}”尚未执行，不能撤销。</translation>
    </message>
    <message>
        <source>{file} row {row} is excluded from &apos;{name}&apos; already.</source>
        <translation>{file} 第 {row} 行已从“{name}”剔除。</translation>
    </message>
    <message>
        <source>{file} row {row} is not excluded from &apos;{name}&apos;.</source>
        <translation>{file} 第 {row} 行未从“{name}”剔除。</translation>
    </message>
    <message>
        <source>&apos;{name}&apos; has no surface to adjust. Fit it first.</source>
        <translation>“{name}”没有可调整的曲面。请先拟合。</translation>
    </message>
    <message>
        <source>&apos;{name}&apos; has no surface to examine. Fit it first.</source>
        <translation>“{name}”没有可检验的曲面。请先拟合。</translation>
    </message>
    <message>
        <source>&apos;{name}&apos; has no surface that could be moved. Fit it first.</source>
        <translation>“{name}”没有可移动的曲面。请先拟合。</translation>
    </message>
    <message>
        <source>&apos;{name}&apos; was read from a file, and its data have changed since. Fit it again, then adjust.</source>
        <translation>“{name}”由文件读入，其数据此后已改变。请重新拟合后再调整。</translation>
    </message>
    <message>
        <source>The surface changed while it was adjusted. Adjust it once more.</source>
        <translation>调整期间曲面已改变。请再调整一次。</translation>
    </message>
    <message>
        <source>The order must name each horizon once: {names}.</source>
        <translation>上下次序中每个层面须且只须出现一次：{names}。</translation>
    </message>
    <message>
        <source>The site&apos;s name is empty. Give it a word.</source>
        <translation>场地名称为空。请填写名称。</translation>
    </message>
    <message>
        <source>A scale of {scale:g} makes a picture of {width} × {height} pixels; give one above 0 and below {most:.1f}.</source>
        <translation>比例 {scale:g} 将产生 {width} × {height} 像素的图片；请取大于 0 且小于 {most:.1f} 的比例。</translation>
    </message>
    <message>
        <source>The process that did the work ended by itself (exit code {code}). Memory may have run out: close other programs and try again.</source>
        <translation>执行任务的进程意外结束（退出码 {code}）。可能内存不足：请关闭其他程序后重试。</translation>
    </message>
    <message>
        <source>Opened %s: %d horizons, %d holes, %d rows not used</source>
        <translation>已打开 %s：层面 %d 个，钻孔与平硐 %d 个，未采用 %d 行</translation>
    </message>
    <message>
        <source>Saved %s</source>
        <translation>已保存 %s</translation>
    </message>
    <message>
        <source>Wrote %s</source>
        <translation>已写出 %s</translation>
    </message>
    <message>
        <source>Stopped: %s</source>
        <translation>已停止：%s</translation>
    </message>
    <message>
        <source>%s failed</source>
        <translation>%s 失败</translation>
    </message>
    <message>
        <source>%s: %s</source>
        <translation>%s：%s</translation>
    </message>
    <message>
        <source>%s: %s since the project was saved.</source>
        <translation>%s：工程保存后%s。</translation>
    </message>
    <message>
        <source>missing</source>
        <translation>已丢失</translation>
    </message>
    <message>
        <source>changed</source>
        <translation>已改变</translation>
    </message>
    <message>
        <source>%s and %s cross at %d places</source>
        <translation>%s 与 %s 有 %d 处相交</translation>
    </message>
    <message>
        <source>The data of %s have changed since: its surface cannot be made again as it was. Fit it.</source>
        <translation>%s 的数据此后已改变：不能照原样重建其曲面。请拟合。</translation>
    </message>
    <message>
        <source>The journal of a session cannot be read (%s); it is kept as %s</source>
        <translation>一次工作的日志无法读取（%s）；已保留为 %s</translation>
    </message>
    <message>
        <source>There is no journal, so that a crash would lose unsaved work: %s</source>
        <translation>没有操作日志，程序崩溃时未保存的工作将丢失：%s</translation>
    </message>
    <message>
        <source>The journal cannot be written any more, so that a crash would lose unsaved work: %s</source>
        <translation>操作日志不能继续写入，程序崩溃时未保存的工作将丢失：%s</translation>
    </message>
    <message>
        <source>No font on this machine has Chinese characters: they are shown as boxes. Install one (Debian and Ubuntu: apt-get install fonts-noto-cjk) and start again.</source>
        <translation>本机没有中文字体，汉字显示为方框。请安装后重新启动（Debian 与 Ubuntu：apt-get install fonts-noto-cjk）。</translation>
    </message>
</context>
<context>
    <name>Scene</name>
    <message>
        <source>Ground</source>
        <translation>地面</translation>
    </message>
    <message>
        <source>Study area</source>
        <translation>研究区范围</translation>
    </message>
    <message>
        <source>Boreholes</source>
        <translation>钻孔</translation>
    </message>
    <message>
        <source>Adits</source>
        <translation>平硐</translation>
    </message>
    <message>
        <source>Section lines</source>
        <translation>剖面线</translation>
    </message>
    <message>
        <source>Measured dips</source>
        <translation>实测产状</translation>
    </message>
    <message>
        <source>Points</source>
        <translation>数据点</translation>
    </message>
    <message>
        <source>Surface</source>
        <translation>曲面</translation>
    </message>
    <message>
        <source>Seams</source>
        <translation>拼接缝</translation>
    </message>
    <message>
        <source>Control points</source>
        <translation>控制点</translation>
    </message>
    <message>
        <source>Upper 90 % bound</source>
        <translation>90 % 上界</translation>
    </message>
    <message>
        <source>Lower 90 % bound</source>
        <translation>90 % 下界</translation>
    </message>
    <message>
        <source>Next holes</source>
        <translation>建议孔位</translation>
    </message>
    <message>
        <source>One colour</source>
        <translation>单色</translation>
    </message>
    <message>
        <source>Kind of source</source>
        <translation>资料来源</translation>
    </message>
    <message>
        <source>Deviation</source>
        <translation>偏差</translation>
    </message>
    <message>
        <source>Elevation</source>
        <translation>高程</translation>
    </message>
    <message>
        <source>Standard deviation</source>
        <translation>标准差</translation>
    </message>
    <message>
        <source>Dip</source>
        <translation>倾角</translation>
    </message>
    <message>
        <source>Thickness below</source>
        <translation>下伏厚度</translation>
    </message>
    <message>
        <source>Gap of the seam</source>
        <translation>拼接缝缝隙</translation>
    </message>
    <message>
        <source>Angle at the seam</source>
        <translation>拼接缝夹角</translation>
    </message>
    <message>
        <source>Borehole</source>
        <translation>钻孔</translation>
    </message>
    <message>
        <source>Adit</source>
        <translation>平硐</translation>
    </message>
    <message>
        <source>Section</source>
        <translation>剖面</translation>
    </message>
    <message>
        <source>Outcrop</source>
        <translation>露头</translation>
    </message>
    <message>
        <source>Geophysics</source>
        <translation>物探</translation>
    </message>
    <message>
        <source>Map</source>
        <translation>平面图</translation>
    </message>
    <message>
        <source>Point</source>
        <translation>点</translation>
    </message>
</context>
<context>
    <name>SceneList</name>
    <message>
        <source>What the scene shows</source>
        <translation>场景内容</translation>
    </message>
    <message>
        <source>Zoom to</source>
        <translation>缩放到</translation>
    </message>
    <message>
        <source>Only this</source>
        <translation>只显示此项</translation>
    </message>
    <message>
        <source>Show all</source>
        <translation>全部显示</translation>
    </message>
    <message>
        <source>Site</source>
        <translation>场地</translation>
    </message>
    <message>
        <source>Nothing to show yet: open or import a site.</source>
        <translation>暂无内容：请打开或导入场地。</translation>
    </message>
</context>
<context>
    <name>SceneView</name>
    <message>
        <source>3D view</source>
        <extracomment>A chosen point is looked at from no farther than this many times the scene&apos;s width. A dragged section is told of at most so often, milliseconds. About so many coordinate lines cross the picture.</extracomment>
        <translation>三维视图</translation>
    </message>
    <message>
        <source>Vertical {factor}×</source>
        <translation>竖向 {factor}×</translation>
    </message>
</context>
<context>
    <name>SeamTable</name>
    <message>
        <source>Seams between patches</source>
        <translation>曲面片之间的拼接缝</translation>
    </message>
    <message>
        <source>No surface yet: press Fit, and the seams between its patches are listed here.</source>
        <translation>尚无曲面：点“拟合”后，曲面片之间的拼接缝列于此处。</translation>
    </message>
    <message>
        <source>This surface is one patch: it has no seams.</source>
        <translation>该曲面仅一个曲面片，无拼接缝。</translation>
    </message>
    <message>
        <source>Seams: {n}; gaps up to {gap:g} mm and angles up to {angle:g}° are allowed</source>
        <translation>拼接缝 {n} 条；允许缝隙 {gap:g} mm、夹角 {angle:g}°</translation>
    </message>
    <message>
        <source>Seams: {n}; gaps up to {gap:g} mm are allowed, and breaks of any angle</source>
        <translation>拼接缝 {n} 条；允许缝隙 {gap:g} mm，夹角不限</translation>
    </message>
    <message>
        <source>Patch</source>
        <translation>曲面片</translation>
    </message>
    <message>
        <source>Meets</source>
        <translation>相邻曲面片</translation>
    </message>
    <message>
        <source>Gap, mm</source>
        <translation>缝隙, mm</translation>
    </message>
    <message>
        <source>Largest distance between the two edges, at 200 places.</source>
        <translation>两边界间的最大距离，取 200 处。</translation>
    </message>
    <message>
        <source>Angle, °</source>
        <translation>夹角, °</translation>
    </message>
    <message>
        <source>Largest angle between the normals of both patches along the seam.</source>
        <translation>沿拼接缝两曲面片法向的最大夹角。</translation>
    </message>
</context>
<context>
    <name>SectionPanel</name>
    <message>
        <source>°</source>
        <extracomment>Wait for the next step of a spin box, milliseconds. Vertical exaggerations on offer, besides the one that is found by itself. A drawing lower than this has no line to spare, logical pixels. A point is picked within so many pixels.</extracomment>
        <translation>°</translation>
    </message>
    <message>
        <source> m</source>
        <translation> m</translation>
    </message>
    <message>
        <source>Auto</source>
        <translation>自动</translation>
    </message>
    <message>
        <source>Along</source>
        <translation>沿</translation>
    </message>
    <message>
        <source>A section of the site, or a line of your own.</source>
        <translation>场地已有剖面，或自定剖面线。</translation>
    </message>
    <message>
        <source>Azimuth</source>
        <translation>方位角</translation>
    </message>
    <message>
        <source>Direction of the section, clockwise from north.</source>
        <translation>剖面方向，自北顺时针。</translation>
    </message>
    <message>
        <source>Position</source>
        <translation>位置</translation>
    </message>
    <message>
        <source>Right of the site&apos;s middle, looking along the azimuth.</source>
        <translation>沿方位角方向看，场地中心以右的距离。</translation>
    </message>
    <message>
        <source>Thickness</source>
        <translation>厚度</translation>
    </message>
    <message>
        <source>Holes and points within half of this to each side.</source>
        <translation>显示两侧各一半厚度内的钻孔和点。</translation>
    </message>
    <message>
        <source>Height</source>
        <translation>高程比例</translation>
    </message>
    <message>
        <source>From ({x0:.1f}, {y0:.1f}) to ({x1:.1f}, {y1:.1f}), {length:.0f} m</source>
        <translation>自（{x0:.1f}，{y0:.1f}）至（{x1:.1f}，{y1:.1f}），长 {length:.0f} m</translation>
    </message>
    <message>
        <source>Vertical {factor}×</source>
        <translation>竖向 {factor}×</translation>
    </message>
    <message>
        <source>Distance, m</source>
        <translation>距离, m</translation>
    </message>
    <message>
        <source>Section drawing</source>
        <translation>剖面图</translation>
    </message>
    <message>
        <source>How much higher elevations are drawn; numbers stay true.</source>
        <translation>高程的放大倍数；数值不受影响。</translation>
    </message>
    <message>
        <source>No site open: open one to cut a section through it.</source>
        <translation>未打开场地：打开后可剖切。</translation>
    </message>
    <message>
        <source>Own line</source>
        <translation>自定</translation>
    </message>
    <message>
        <source>Cutting…</source>
        <translation>正在剖切……</translation>
    </message>
    <message>
        <source>No surfaces yet: press Fit to see their traces.</source>
        <translation>尚无曲面：点“拟合”后显示剖面迹线。</translation>
    </message>
    <message>
        <source>Section</source>
        <translation>剖面</translation>
    </message>
    <message>
        <source>ground</source>
        <translation>地面</translation>
    </message>
    <message>
        <source>90 % band</source>
        <translation>90 % 置信带</translation>
    </message>
    <message>
        <source>Distance along the section, m</source>
        <translation>沿剖面距离, m</translation>
    </message>
    <message>
        <source>Elevation, m</source>
        <translation>高程, m</translation>
    </message>
</context>
<context>
    <name>Selecting</name>
    <message>
        <source>There is no surface yet: press Fit.</source>
        <translation>尚无曲面：请点“拟合”。</translation>
    </message>
</context>
<context>
    <name>ShortcutsDialog</name>
    <message>
        <source>Keyboard shortcuts</source>
        <extracomment>Pixels between an action and its keys.</extracomment>
        <translation>快捷键</translation>
    </message>
    <message>
        <source>Action</source>
        <translation>操作</translation>
    </message>
    <message>
        <source>Key</source>
        <translation>按键</translation>
    </message>
</context>
<context>
    <name>StartPage</name>
    <message>
        <source>Open &amp;sample site</source>
        <translation>打开示例场地(&amp;S)</translation>
    </message>
    <message>
        <source>A fictional dam site to try</source>
        <translation>虚构坝址，供试用</translation>
    </message>
    <message>
        <source>&amp;Open project or site…</source>
        <translation>打开工程或场地(&amp;O)...</translation>
    </message>
    <message>
        <source>*.geofit or site.toml</source>
        <translation>*.geofit 或 site.toml</translation>
    </message>
    <message>
        <source>&amp;New site from files…</source>
        <translation>由文件新建场地(&amp;N)...</translation>
    </message>
    <message>
        <source>CSV, XLSX, DXF, AGS, LAS, grids</source>
        <translation>CSV、XLSX、DXF、AGS、LAS、格网</translation>
    </message>
    <message>
        <source>Recent files</source>
        <translation>最近的文件</translation>
    </message>
    <message>
        <source>Projects that you open will be listed here.</source>
        <translation>打开过的工程将列于此处。</translation>
    </message>
    <message>
        <source>Drop tables, drawings, grids or a project here</source>
        <translation>将表格、图件、格网或工程拖到此处</translation>
    </message>
    <message>
        <source>Start</source>
        <translation>开始</translation>
    </message>
    <message>
        <source>Recent</source>
        <translation>最近</translation>
    </message>
    <message>
        <source>NURBS surfaces of geological horizons, with a stated tolerance</source>
        <translation>地质层面的 NURBS 曲面，精度有据可查</translation>
    </message>
</context>
<context>
    <name>SystemReport</name>
    <message>
        <source>System report</source>
        <translation>系统信息</translation>
    </message>
    <message>
        <source>&amp;Copy</source>
        <translation>复制(&amp;C)</translation>
    </message>
</context>
<context>
    <name>TablePage</name>
    <message>
        <source>What the rows are</source>
        <extracomment>Ground of a cell that should hold a number and does not, on light and dark.</extracomment>
        <translation>各行的内容</translation>
    </message>
    <message>
        <source>Encoding</source>
        <translation>编码</translation>
    </message>
    <message>
        <source>Separator</source>
        <translation>分隔符</translation>
    </message>
    <message>
        <source>Decimal mark</source>
        <translation>小数点</translation>
    </message>
    <message>
        <source>Unit of lengths</source>
        <translation>长度单位</translation>
    </message>
    <message>
        <source>&amp;Rows are</source>
        <translation>各行为(&amp;R)</translation>
    </message>
    <message>
        <source>&amp;Encoding</source>
        <translation>编码(&amp;E)</translation>
    </message>
    <message>
        <source>&amp;Separator</source>
        <translation>分隔符(&amp;S)</translation>
    </message>
    <message>
        <source>&amp;Decimal mark</source>
        <translation>小数点(&amp;D)</translation>
    </message>
    <message>
        <source>&amp;Unit of lengths</source>
        <translation>长度单位(&amp;U)</translation>
    </message>
    <message>
        <source>E&amp;xchange easting and northing</source>
        <translation>互换东坐标与北坐标(&amp;X)</translation>
    </message>
    <message>
        <source>{kind} ({share:.0%} likely)</source>
        <translation>{kind}（可能性 {share:.0%}）</translation>
    </message>
    <message>
        <source>comma</source>
        <translation>逗号</translation>
    </message>
    <message>
        <source>semicolon</source>
        <translation>分号</translation>
    </message>
    <message>
        <source>tab</source>
        <translation>制表符</translation>
    </message>
    <message>
        <source>blanks</source>
        <translation>空格</translation>
    </message>
    <message>
        <source>Role of column {name}</source>
        <translation>{name} 列的含义</translation>
    </message>
    <message>
        <source>Guessed, {share:.0%} sure</source>
        <translation>自动识别，把握 {share:.0%}</translation>
    </message>
    <message>
        <source>No number: the row will be listed, not used.</source>
        <translation>不是数字：该行将列出而不采用。</translation>
    </message>
    <message>
        <source>No number: it makes no pick.</source>
        <translation>不是数字：不成点。</translation>
    </message>
    <message>
        <source>This file is left out.</source>
        <translation>此文件不导入。</translation>
    </message>
    <message>
        <source>Nothing is known of these rows. Say what they are, or leave the table out.</source>
        <translation>未能识别这些行。请指明其内容，或选择不导入。</translation>
    </message>
    <message>
        <source>This table is left out; its rows are listed as such.</source>
        <translation>此表不导入，其各行将如此列出。</translation>
    </message>
    <message>
        <source>Still needed: {roles}. Name the column above the rows.</source>
        <translation>尚缺：{roles}。请在表头上方指定相应的列。</translation>
    </message>
    <message>
        <source>No column holds upper limits: they are taken from the row above, 0 at the first.</source>
        <translation>没有上界列：取上一行的下界，首行取 0。</translation>
    </message>
    <message>
        <source>No column names a horizon: all points are of &apos;{name}&apos;.</source>
        <translation>没有注明层面的列：全部点属于“{name}”。</translation>
    </message>
    <message>
        <source>Red cells are no numbers ({count} shown): such rows will be listed, not used.</source>
        <translation>红色单元格不是数字（显示 {count} 个）：相应各行将列出而不采用。</translation>
    </message>
    <message>
        <source>Easting and northing look exchanged: in many Chinese tables X is the northing, Y the easting.</source>
        <translation>东坐标与北坐标似已互换：国内许多表格以 X 为北坐标、Y 为东坐标。</translation>
    </message>
    <message>
        <source>{kind}: nothing to name.</source>
        <translation>{kind}：无需指定列。</translation>
    </message>
    <message>
        <source>Or add the ground, a grid of elevations: the collars will stand on it.</source>
        <translation>或添加地面高程格网：孔口将位于其上。</translation>
    </message>
    <message>
        <source>{count} rows, the first {shown} shown.</source>
        <translation>共 {count} 行，显示前 {shown} 行。</translation>
    </message>
    <message>
        <source>Columns are named as the last time this header came.</source>
        <translation>各列含义沿用上次相同表头的设置。</translation>
    </message>
</context>
<context>
    <name>TaskDialog</name>
    <message>
        <source>Progress</source>
        <extracomment>Milliseconds before the progress of a task is shown: what is quick needs none.</extracomment>
        <translation>进度</translation>
    </message>
    <message>
        <source>&amp;Stop</source>
        <translation>停止(&amp;S)</translation>
    </message>
    <message>
        <source>{reason}. Check that the folder is there, can be written and has room, and that no other program has the file open.</source>
        <translation>{reason}。请确认文件夹存在、可写、有足够空间，且文件未被其他程序打开。</translation>
    </message>
    <message>
        <source>This is a mistake in geofit, not in your data; please report it: {error}</source>
        <translation>这是 geofit 的错误，与您的数据无关；请反馈：{error}</translation>
    </message>
</context>
<context>
    <name>VerdictBadge</name>
    <message>
        <source>No surface yet</source>
        <translation>尚无曲面</translation>
    </message>
    <message>
        <source>Press Fit to lay one and check it against ε.</source>
        <translation>点“拟合”生成曲面，并按 ε 检验。</translation>
    </message>
    <message>
        <source>PASS</source>
        <translation>合格</translation>
    </message>
    <message>
        <source>FAIL</source>
        <translation>不合格</translation>
    </message>
    <message>
        <source>σ {sigma} m &lt; ε {epsilon} m</source>
        <translation>σ {sigma} m &lt; ε {epsilon} m</translation>
    </message>
    <message>
        <source>σ {sigma} m ≥ ε {epsilon} m</source>
        <translation>σ {sigma} m ≥ ε {epsilon} m</translation>
    </message>
    <message>
        <source>{count} over {limit}</source>
        <translation>超 {limit}：{count} 点</translation>
    </message>
    <message>
        <source>max |d| {most} m of {n} points</source>
        <translation>{n} 点最大 |d| {most} m</translation>
    </message>
    <message>
        <source>Older than the settings: press Fit</source>
        <translation>早于当前设置：请点“拟合”</translation>
    </message>
    <message>
        <source>σ = √(Σ d² / (n − 1)) over all {n} original points, d the orthogonal distance to the surface; the surface passes when σ is below the control error ε.</source>
        <translation>σ = √(Σ d² / (n − 1))，对全部 {n} 个原始点计算，d 为点到曲面的正交距离；σ 小于控制误差 ε 时曲面合格。</translation>
    </message>
</context>
<context>
    <name>WeightBox</name>
    <message>
        <source>Weight</source>
        <translation>权</translation>
    </message>
    <message>
        <source>1 is neutral; above 1 the surface is drawn to the control point, below 1 it is let go.</source>
        <translation>1 为中性；大于 1 时曲面靠近控制点，小于 1 时远离。</translation>
    </message>
    <message>
        <source>Set</source>
        <translation>设置</translation>
    </message>
    <message>
        <source>Give the control point this weight. Undo takes it back.</source>
        <translation>将控制点的权设为此值；可撤销。</translation>
    </message>
</context>
<context>
    <name>Workspace</name>
    <message>
        <source>Project</source>
        <translation>工程</translation>
    </message>
    <message>
        <source>Scene</source>
        <translation>场景</translation>
    </message>
    <message>
        <source>Fit</source>
        <translation>拟合</translation>
    </message>
    <message>
        <source>Adjust by hand</source>
        <translation>手工调整</translation>
    </message>
    <message>
        <source>Residuals</source>
        <translation>残差</translation>
    </message>
    <message>
        <source>Section</source>
        <translation>剖面</translation>
    </message>
    <message>
        <source>Histogram</source>
        <translation>直方图</translation>
    </message>
    <message>
        <source>Plan</source>
        <translation>平面图</translation>
    </message>
    <message>
        <source>Seams</source>
        <translation>拼接缝</translation>
    </message>
    <message>
        <source>Checks</source>
        <translation>检查</translation>
    </message>
    <message>
        <source>Off the data</source>
        <translation>数据点以外</translation>
    </message>
    <message>
        <source>Log</source>
        <translation>日志</translation>
    </message>
</context>
<context>
    <name>_Issues</name>
    <message>
        <source>not used</source>
        <translation>未采用</translation>
    </message>
    <message>
        <source>look</source>
        <translation>请复核</translation>
    </message>
    <message>
        <source>note</source>
        <translation>说明</translation>
    </message>
    <message>
        <source>State</source>
        <translation>状态</translation>
    </message>
    <message>
        <source>File</source>
        <translation>文件</translation>
    </message>
    <message>
        <source>Row</source>
        <translation>行</translation>
    </message>
    <message>
        <source>Column</source>
        <translation>列</translation>
    </message>
    <message>
        <source>Value</source>
        <translation>数值</translation>
    </message>
    <message>
        <source>Reason</source>
        <translation>原因</translation>
    </message>
    <message>
        <source>What to do</source>
        <translation>处理方法</translation>
    </message>
</context>
<context>
    <name>_LayerForm</name>
    <message>
        <source>Opacity</source>
        <translation>不透明度</translation>
    </message>
    <message>
        <source>Colour by</source>
        <translation>着色依据</translation>
    </message>
    <message>
        <source>Lines of equal elevation</source>
        <translation>等高线</translation>
    </message>
    <message>
        <source>Names</source>
        <translation>名称</translation>
    </message>
    <message>
        <source>{percent} %</source>
        <translation>{percent} %</translation>
    </message>
</context>
<context>
    <name>_Table</name>
    <message>
        <source>Exclude this row from the fit</source>
        <extracomment>Wait for the next letter of the filter, milliseconds.</extracomment>
        <translation>从拟合中剔除该行</translation>
    </message>
    <message>
        <source>Pull the surface to this point</source>
        <translation>将曲面拉近到该点</translation>
    </message>
</context>
</TS>
