// White walls, for the step between a wall and a model beside it. The same color for bounced light as on the screen.
textures/wall_room/white
{
	q3map_lightRGB 0.8 0.8 0.8
	{
		map $lightmap
		rgbGen identity
	}
	{
		map $whiteimage
		blendFunc filter
	}
}
