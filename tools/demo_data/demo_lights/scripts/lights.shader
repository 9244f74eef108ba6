// Walls of the bays, lamps, skies and models of the demo of lights.
textures/lights/wall
{
	qer_editorimage textures/lights/wall.png
	q3map_lightmapSampleSize 4
	{
		map $lightmap
		rgbGen identity
	}
	q3map_styleMarker
	{
		map textures/lights/wall.png
		blendFunc filter
	}
}
textures/lights/floor
{
	qer_editorimage textures/lights/floor.png
	q3map_lightmapSampleSize 4
	{
		map $lightmap
		rgbGen identity
	}
	q3map_styleMarker
	{
		map textures/lights/floor.png
		blendFunc filter
	}
}
textures/lights/step
{
	qer_editorimage textures/lights/floor.png
	q3map_lightmapSampleSize 8
	{
		map $lightmap
		rgbGen identity
	}
	q3map_styleMarker
	{
		map textures/lights/floor.png
		blendFunc filter
	}
}
textures/lights/hallfloor
{
	qer_editorimage textures/lights/floor.png
	{
		map $lightmap
		rgbGen identity
	}
	q3map_styleMarker
	{
		map textures/lights/floor.png
		blendFunc filter
	}
}
textures/lights/slate
{
	qer_editorimage textures/lights/slate.png
	{
		map $lightmap
		rgbGen identity
	}
	q3map_styleMarker
	{
		map textures/lights/slate.png
		blendFunc filter
	}
}
textures/lights/red
{
	q3map_lightRGB 0.9 0.12 0.1
	q3map_lightmapSampleSize 4
	{
		map $lightmap
		rgbGen identity
	}
	q3map_styleMarker
	{
		map $whiteimage
		blendFunc filter
		rgbGen const ( 0.9 0.12 0.1 )
	}
}
textures/lights/green
{
	q3map_lightRGB 0.15 0.8 0.2
	q3map_lightmapSampleSize 4
	{
		map $lightmap
		rgbGen identity
	}
	q3map_styleMarker
	{
		map $whiteimage
		blendFunc filter
		rgbGen const ( 0.15 0.8 0.2 )
	}
}
textures/lights/sign
{
	qer_editorimage textures/lights/signs.png
	surfaceparm nolightmap
	surfaceparm nomarks
	nomipmaps
	nopicmip
	{
		map textures/lights/signs.png
	}
}
textures/lights/panel
{
	surfaceparm nomarks
	surfaceparm nolightmap
	q3map_lightRGB 1 0.93 0.8
	q3map_surfacelight 1700
	q3map_lightSubdivide 32
	{
		map $whiteimage
		rgbGen const ( 1 0.93 0.8 )
	}
}
textures/lights/tube
{
	surfaceparm nomarks
	surfaceparm nolightmap
	{
		map $whiteimage
		rgbGen const ( 0.62 0.85 1 )
	}
}
textures/lights/sky
{
	surfaceparm sky
	surfaceparm noimpact
	surfaceparm nolightmap
	{
		map $whiteimage
		rgbGen const ( 0.66 0.8 1 )
	}
}
textures/lights/sky_east
{
	surfaceparm sky
	surfaceparm noimpact
	surfaceparm nolightmap
	q3map_lightRGB 1 0.45 0.2
	q3map_sunExt 1 0.5 0.2 320 315 20 2 16
	q3map_skyLight 220 3
	{
		map $whiteimage
		rgbGen const ( 1 0.55 0.3 )
	}
}
textures/lights/glass
{
	qer_editorimage textures/lights/glass.png
	surfaceparm trans
	surfaceparm nonsolid
	surfaceparm nomarks
	surfaceparm nolightmap
	surfaceparm lightfilter
	cull none
	{
		map textures/lights/glass.png
		blendFunc blend
		rgbGen const ( 0.6 0.6 0.6 )
	}
}
textures/lights/grate
{
	qer_editorimage textures/lights/grate.png
	surfaceparm trans
	surfaceparm nonsolid
	surfaceparm nomarks
	surfaceparm nolightmap
	surfaceparm alphashadow
	cull none
	{
		map textures/lights/grate.png
		alphaFunc GE128
	}
}
textures/lights/clear
{
	surfaceparm trans
	surfaceparm nonsolid
	surfaceparm nodraw
	surfaceparm nolightmap
	surfaceparm nomarks
}
models/lights/stone
{
	qer_editorimage textures/lights/stone.png
	{
		map textures/lights/stone.png
		rgbGen vertex
	}
}
models/lights/leaf
{
	qer_editorimage textures/lights/leaf.png
	surfaceparm trans
	surfaceparm alphashadow
	cull none
	{
		map textures/lights/leaf.png
		alphaFunc GE128
		rgbGen vertex
	}
}
models/lights/bulb
{
	surfaceparm nolightmap
	surfaceparm nonsolid
	{
		map $whiteimage
		rgbGen const ( 1 0.97 0.88 )
	}
}
