/// Colours and strokes of all figures: after Okabe and Ito, told apart by the
/// colour-blind, darker on white and lighter on black. Shapes and dashes say the
/// same once more.
pub const STYLE: &str = "\
.plot { font-family: system-ui, 'Segoe UI', 'DejaVu Sans', sans-serif; font-size: 13px; color: #1b1b1b; }
.plot text { fill: currentColor; }
.plot .small { font-size: 12px; }
.plot .heading { font-size: 15px; font-weight: 600; }
.plot .ground { fill: #ffffff; }
.plot .mesh { stroke: #e2e2e2; fill: none; }
.plot .edge { stroke: #8a8a8a; fill: none; }
.plot .rule { stroke: #5f5f5f; stroke-dasharray: 6 4; fill: none; stroke-width: 1.4; }
.plot .halo { paint-order: stroke; stroke: #ffffff; stroke-width: 4px; stroke-linejoin: round; }
.plot .line { fill: none; stroke: currentColor; stroke-linejoin: round; }
.plot .dots { fill: none; stroke: currentColor; stroke-linecap: round; stroke-width: 3.2px; stroke-opacity: 0.45; }
.plot .shape { fill: currentColor; fill-opacity: 0.75; stroke: currentColor; }
.plot .bar { fill: currentColor; fill-opacity: 0.85; }
.plot .band { fill: currentColor; fill-opacity: 0.22; stroke: none; }
.plot .thin { fill: none; stroke: currentColor; stroke-width: 1.3px; }
.plot .tread { fill: none; stroke: currentColor; stroke-width: 4px; stroke-linecap: round; }
.plot .i2 .tread { stroke-dasharray: 1 8; stroke-width: 5px; }
.plot .riser { fill: none; stroke: currentColor; stroke-width: 1.2px; stroke-dasharray: 2 3; }
.plot .i0 { color: #0072b2; } .plot .i1 { color: #c94f00; } .plot .i2 { color: #00805c; }
.plot .i3 { color: #a63d7c; } .plot .i4 { color: #2a91cf; } .plot .i5 { color: #b07a00; }
.plot .i6 { color: #6b6b6b; } .plot .i7 { color: #8b2f2f; } .plot .i8 { color: #222222; }
.plot .i9 { color: #6b6f00; }
@media (prefers-color-scheme: dark) {
.plot { color: #e6e6e6; }
.plot .ground { fill: #16181b; }
.plot .mesh { stroke: #33373d; }
.plot .edge { stroke: #878d96; }
.plot .rule { stroke: #b8b8b8; }
.plot .halo { stroke: #16181b; }
.plot .i0 { color: #56b4e9; } .plot .i1 { color: #ff8a3d; } .plot .i2 { color: #2fd0a0; }
.plot .i3 { color: #ee9ccb; } .plot .i4 { color: #9fdcff; } .plot .i5 { color: #f5c542; }
.plot .i6 { color: #a9adb3; } .plot .i7 { color: #e58b8b; } .plot .i8 { color: #f2f2f2; }
.plot .i9 { color: #d2d65a; }
}
@media print {
.plot { color: #000000; }
.plot .ground { fill: #ffffff; }
.plot .mesh { stroke: #dddddd; }
.plot .halo { stroke: #ffffff; }
.plot .i0 { color: #0072b2; } .plot .i1 { color: #c94f00; } .plot .i2 { color: #00805c; }
.plot .i3 { color: #a63d7c; } .plot .i4 { color: #2a91cf; } .plot .i5 { color: #b07a00; }
.plot .i6 { color: #6b6b6b; } .plot .i7 { color: #8b2f2f; } .plot .i8 { color: #222222; }
.plot .i9 { color: #6b6f00; }
}
";
