// Demo arena: walls without textures, a lamp that shines, a sky with a sun.
textures/demo/wall
{
	q3map_lightRGB 0.6 0.6 0.6
	{
		map $whiteimage
		rgbGen exactVertex
	}
}
textures/demo/floor
{
	q3map_lightRGB 0.5 0.45 0.4
	{
		map $whiteimage
		rgbGen exactVertex
	}
}
textures/demo/trim
{
	q3map_lightRGB 0.4 0.4 0.45
	{
		map $whiteimage
		rgbGen exactVertex
	}
}
textures/demo/redlamp
{
	surfaceparm nomarks
	{
		map $whiteimage
		rgbGen const ( 1 0.2 0.1 )
	}
}
textures/demo/bluelamp
{
	surfaceparm nomarks
	{
		map $whiteimage
		rgbGen const ( 0.1 0.3 1 )
	}
}
textures/demo/warmlamp
{
	surfaceparm nomarks
	q3map_lightRGB 1 0.75 0.45
	q3map_surfacelight 2500
	{
		map $whiteimage
		rgbGen const ( 1 0.75 0.45 )
	}
}
textures/demo/sky
{
	surfaceparm sky
	surfaceparm noimpact
	surfaceparm nolightmap
	q3map_lightRGB 0.55 0.75 1
	q3map_sunExt 1 0.95 0.85 180 20 60 1 8
	q3map_skyLight 60 3
	{
		map $whiteimage
		rgbGen const ( 0.55 0.75 1 )
	}
}
textures/demo/door
{
	q3map_lightRGB 0.45 0.3 0.2
	{
		map $whiteimage
		rgbGen exactVertex
	}
}
textures/demo/hint
{
	surfaceparm nodraw
	surfaceparm nonsolid
	surfaceparm structural
	surfaceparm trans
	surfaceparm hint
}
textures/demo/skip
{
	surfaceparm nodraw
	surfaceparm nonsolid
	surfaceparm structural
	surfaceparm trans
	surfaceparm skip
}
