# Generated: q3map2 -help bash > tools/generated/completions/q3map2.bash
_q3map2() {
    local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]}
    local options="" values="" list="" paths="" before="" word
    COMPREPLY=()
    case $previous in
        -cache|-fs_basepath|-fs_game|-fs_basegame|-fs_home|-fs_homebase|-fs_homepath|-fs_pakpath|-lightmapdir|-vproject|-insert_search_path|-outdir) paths=-d ;;
        -log|-report|-tempname|-bspfile|-srffile|-prtfile|-linfile|-partfile|-join|-shpreview|-lights|-macrotexture|-out|-o|-normals|-exclude) paths=-f ;;
        -cachesize|-threads|-connect|-subdivisions|-maxmapdrawsurfs|-fs_forbiddenpath|-samplesize|-minsamplesize|-mv|-mi|-np|-metaadequatescore|-metagoodscore|-celshader|-ne|-de|-snap|-clipdepth|-flowrounds|-vismemory|-part|-gridscalesh|-gridsh|-shnames|-sherrortarget|-shbudget|-shsamples|-cubesperleaf|-cubetolerance|-scale|-point|-pointscale|-spherical|-sphericalscale|-spot|-spotscale|-area|-areascale|-sky|-skyscale|-gridscale|-gridambientscale|-backsplash|-backsplasharea|-griddirectionality|-gridambientdirectionality|-extradist|-contrast|-gamma|-exposure|-saturation|-compensate|-explain|-super|-supersample|-samplessearchboxsize|-thresh|-samplescale|-rawlightmapsizelimit|-shadeangle|-dirtdepth|-dirtscale|-dirtgain|-bouncetime|-bouncerays|-bouncescale|-bouncecolorratio|-vertexscale|-lightmapsize|-extlmhacksize|-brightness|-approx|-shadowmap|-lightmapsearchblocksize|-lightmapsearchpower|-smooth|-reflectivityscale|-chop|-maxchop|-dispchop|-maxdispchop|-choptexlights|-softsun|-extrasky|-extrapasses|-luxeldensity|-ambient|-maxlight|-dlight|-mpi_pw|-bspoptions|-visoptions|-lightoptions|-draftoptions|-port|-texturesize|-page|-size|-border|-minmax|-samples|-random|-boost|-sharpen|-places|-bumpscale|-rays|-filter|-complevel|-basepak|-spawn_ref) return ;;
        -lightanglehl|-dirtmode|-deluxemode) values="0 1" ;;
        -help|--help|-h) values="all game keys shader vrad bsp vis light watch convertgrid info json convert export import tonemap exportents minimap analyze shpreview shreport ssbump pk3 repack scale shift mergebsp recoverlights fixaas editorfiles" ;;
        -format) values="ase obj map map_bp map_220 quake3 quakelive nexuiz xonotic tremulous unvanquished tenebrae wolf et etut ef reaction darkplaces dq prophecy sof2 jk2 ja qfusion" ;;
        -preset) values="draft normal final" ;;
        -hdrformat) values="exr pfm hdr exp32 rend2 ioquake3" ;;
        -operator) values="filmic clamp" ;;
        -bounce) values="inf" ;;
        -reflectivity) values="legacy linear" ;;
        -ambientcubesfrom) values="light sh" ;;
        -globalflag) values="lightgrid antiportal skip origin areaportal trans detail structural hint nodraw alphashadow lightfilter nolightmap pointlight nonsolid trigger water slime lava playerclip monsterclip nodrop clusterportal donotenter botclip fog sky slick noimpact nomarks ladder nodamage metalsteps flesh nosteps nodlight dust noob ob" ;;
        -game) values="quake3 quakelive nexuiz xonotic tremulous unvanquished tenebrae wolf et etut ef reaction darkplaces dq prophecy sof2 jk2 ja qfusion" ;;
        -rnmstorage) values="raw rescaled" ;;
        -hdrfiles) values="rend2 ioquake3 exr pfm" ;;
        -gridformats) values="sh shbspx sparse legacy legacy-ioq3 legacy-daemon raw-ioq3 raw-rend2 octree grids" list=1 ;;
    esac
    if [[ -n $values ]]; then
        [[ -n $list && $current == *,* ]] && before=${current%,*},
        mapfile -t COMPREPLY < <(compgen -P "$before" -W "$values" -- "${current#"$before"}")
        return
    fi
    for word in "${COMP_WORDS[@]:1}"; do
        case $word in
            -bsp) options="-preset -meta -patchmeta -leaktest -onlyents -keeplights -keepmodels -nodetail -fulldetail -nowater -nohint -nocurves -nofog -nosubdivide -notjunc -samplesize -minsamplesize -mv -mi -np -metaadequatescore -metagoodscore -maxarea -nobrushsnap -flares -noflares -skyfix -celshader -flat -ne -de -snap -deep -altsplit -clipdepth -rename -custinfoparms -noob -globalflag -sRGBcolor -nosRGBcolor -tempname -autocaulk -debugsurfaces -debuginset -debugportals -debugclip -fakemap -verboseentities -sRGBtex -bspfile -srffile -prtfile -linfile " ;;
            -vis) options="-preset -saveprt -fast -merge -hint -mergeportals -nopassage -passageOnly -nosort -flowrounds -vismemory -plain -v -part -partfile -join -bspfile -prtfile " ;;
            -light) options="-preset -sh -shbspx -shradiance -gridformats -shsmall -gridscalesh -gridsh -shadaptive -shlights -shnames -sherrortarget -shbudget -shdering -sherror -shfit -noshfill -shsamples -shpreview -ambientcubes -ambientcubesfrom -cubesperleaf -cubetolerance -noskip -noskipreach -noskippvs -noskipfaint -noskipmoments -noskipprobes -noskipsmooth -noskipcoarse -scale -point -spherical -spot -area -sky -gridscale -gridambientscale -backsplash -backsplasharea -lights -recoverlights -griddirectionality -gridambientdirectionality -extradist -wolf -q3 -contrast -gamma -exposure -saturation -compensate -sRGBlight -nosRGBlight -sRGBcolor -nosRGBcolor -sRGBtex -nosRGBtex -sRGB -nosRGB -fast -fastgrid -faster -cheap -cheapgrid -nogrid -notrace -areashadows -nosurf -patchshadows -sunonly -onesky -style -nostyle -switchable -floodlight -lowquality -custinfoparms -staticproplighting -staticproppolys -textureshadows -staticpropfiles -fixaas -explain -onlygrid -super -samples -randomsamples -samplessearchboxsize -filter -thresh -samplesize -minsamplesize -samplescale -rawlightmapsizelimit -shade -shadeangle -lightanglehl -nofastpoint -dark -trianglecheck -extravisnudge -dirty -dirtdepth -dirtscale -dirtgain -dirtmode -bounce -bouncetime -bouncerays -reflectivity -bouncegrid -bounceonly -bouncescale -bouncecolorratio -vertexscale -novertex -cpma -nolm -lightmapsize -external -lightmapdir -extlmhacksize -deluxe -nodeluxe -deluxemode -brightness -macrotexture -approx -hdr -both -hdrfiles -ldr -rnm -rnmall -rnmstorage -lightmass -skyocclusion -shadowmap -nocollapse -slowallocate -lightmapsearchblocksize -lightmapsearchpower -nolightmapsearch -fill -export -trisoup -debug -border -fillpink -debugsurfaces -debugaxis -debugcluster -debugorigin -dirtdebug -normalmap -debugnormals -debugdeluxe -debugsamplesize -bspfile -srffile -part -partfile -join -final -extra -noextra -fastambient -smooth -reflectivityscale -chop -maxchop -dispchop -maxdispchop -choptexlights -softsun -extrasky -extrapasses -luxeldensity -centersamples -ambient -maxlight -dlight -noskyboxrecurse -nodetaillight -onlydetail -nossprops -staticpropnormals -dumpnormals -debugextra -rederrors -low -mpi -mpi_pw -vproject -insert_search_path -novconfig -stoponexit -compressconstant -loghash -verbose -lomem -fastallocate -fastbounce -nobouncestore -dump " ;;
            -watch) options="-bspoptions -visoptions -lightoptions -draftoptions -port -texturesize -open " ;;
            -convertgrid) options="-gridformats -out -gridambientscale -sherrortarget -shbudget -fixaas " ;;
            -info) options="" ;;
            -json) options="-unpack -pack -useflagnames -skipflags " ;;
            -convert) options="-format -readmap -readbsp -fast -modelclip -wtf -ne -de -shadersasbitmap -lightmapsastexcoord -deluxemapsastexcoord -meta -patchmeta " ;;
            -export) options="-hdrformat " ;;
            -import) options="-hdrformat " ;;
            -tonemap) options="-exposure -operator -page " ;;
            -exportents) options="" ;;
            -minimap) options="-size -border -keepaspect -nokeepaspect -minmax -gray -black -white -o -samples -random -boost -autolevel -noautolevel -contrast -brightness -sharpen " ;;
            -analyze) options="-lumpswap " ;;
            -shpreview) options="" ;;
            -shreport) options="-texturesize -o -explain -places " ;;
            -ssbump) options="-bumpscale -notile -rays -filter -normals " ;;
            -pk3) options="-dbg -png -complevel -outdir -basepak -exclude " ;;
            -repack) options="-dbg -png -complevel -outdir -basepak -exclude -analyze " ;;
            -scale) options="-tex -spawn_ref " ;;
            -shift) options="" ;;
            -mergebsp) options="-fixnames -world " ;;
            -recoverlights) options="-insert " ;;
            -fixaas) options="" ;;
            -editorfiles) options="" ;;
        esac
    done
    if [[ -z $paths && $current == -* ]]; then
        [[ -z $options ]] && options="-bsp -vis -light -watch -convertgrid -info -json -convert -export -import -tonemap -exportents -minimap -analyze -shpreview -shreport -ssbump -pk3 -repack -scale -shift -mergebsp -recoverlights -fixaas -editorfiles -preset -meta -patchmeta -leaktest -onlyents -keeplights -keepmodels -nodetail -fulldetail -nowater -nohint -nocurves -nofog -nosubdivide -notjunc -samplesize -minsamplesize -mv -mi -np -metaadequatescore -metagoodscore -maxarea -nobrushsnap -flares -noflares -skyfix -celshader -flat -ne -de -snap -deep -altsplit -clipdepth -rename -custinfoparms -noob -globalflag -sRGBcolor -nosRGBcolor -tempname -autocaulk -debugsurfaces -debuginset -debugportals -debugclip -fakemap -verboseentities -sRGBtex -bspfile -srffile -prtfile -linfile "
        mapfile -t COMPREPLY < <(compgen -W "$options -help -version -v -cache -cachesize -threads -force -log -report -connect -subdivisions -maxmapdrawsurfs -game -fs_basepath -fs_game -fs_basegame -fs_home -fs_homebase -fs_homepath -fs_nobasepath -fs_nohomepath -fs_nomagicpath -fs_pakpath -fs_forbiddenpath " -- "$current")
    else
        compopt -o filenames 2>/dev/null
        mapfile -t COMPREPLY < <(compgen "${paths:--f}" -- "$current")
    fi
}
complete -F _q3map2 q3map2
