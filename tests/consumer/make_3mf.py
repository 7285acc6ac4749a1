"""Writes a tetrahedron as the file that its argument names, a 3MF of the fewest parts."""

import sys
import zipfile

CORNERS = [(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)]
FACES = [(0, 1, 2), (0, 3, 1), (0, 2, 3), (1, 3, 2)]
SCHEMAS = "http://schemas.openxmlformats.org/package/2006"
MICROSOFT = "http://schemas.microsoft.com/3dmanufacturing"

vertices = "".join('<vertex x="%d" y="%d" z="%d"/>' % corner for corner in CORNERS)
triangles = "".join('<triangle v1="%d" v2="%d" v3="%d"/>' % face for face in FACES)
PARTS = {
    "[Content_Types].xml": f'<Types xmlns="{SCHEMAS}/content-types">'
    '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>',
    "_rels/.rels": f'<Relationships xmlns="{SCHEMAS}/relationships"><Relationship Target="/3D/3dmodel.model" Id="r" '
    f'Type="{MICROSOFT}/2013/01/3dmodel"/></Relationships>',
    "3D/3dmodel.model": f'<model unit="millimeter" xmlns="{MICROSOFT}/core/2015/02"><resources><object id="1" type="model">'
    f"<mesh><vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh></object></resources>"
    '<build><item objectid="1"/></build></model>',
}
with zipfile.ZipFile(sys.argv[1], "w", zipfile.ZIP_DEFLATED) as archive:
    for name, text in PARTS.items():
        archive.writestr(name, '<?xml version="1.0" encoding="UTF-8"?>' + text)
